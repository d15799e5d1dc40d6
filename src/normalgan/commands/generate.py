"""normalgan generate: from drawings to normal maps by a model as ONNX, without torch."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from typing import Literal

from jsonargparse import Namespace

from normalgan import decoding
from normalgan.commands.light_parser import LightParser
from normalgan.drawings import MOST_BYTES
from normalgan.errors import InputError, named, one_line, unwritable
from normalgan.painting.inputs import check_size
from normalgan.painting.jobs import STDIN, Job, find_files, plan
from normalgan.painting.onnx_backend import OnnxBackend, find_model
from normalgan.painting.outputs import Outputs
from normalgan.painting.packing import Packing
from normalgan.painting.paint_job import JobPainter
from normalgan.painting.painter import Painter
from normalgan.painting.parallel import stream


def run(arguments: list[str]) -> int:
    """Paint what the arguments ask for and return the exit code.

    Raises:
        InputError: if something that was given cannot be used.
    """
    return generate(build_parser().parse_args(arguments))


def build_parser() -> LightParser:
    """Return the parser of the command line."""
    parser = LightParser(
        prog="normalgan generate",
        usage="%(prog)s SKETCH... [-o FOLDER] [--SETTING VALUE]...",
        description="Paint normal maps for drawings.",
    )
    parser.add_argument(
        "sketches", nargs="+", help="files, folders or globs of drawings; - reads one from standard input"
    )
    parser.add_argument("-o", "--output", default="normals", help="folder where the maps go")
    parser.add_argument("--dry-run", action="store_true", help="only say what would be read and written")
    drawing = parser.add_argument_group("How a drawing is painted")
    drawing.add_argument(
        "--model", type=str | None, help="what normalgan export wrote; null is the package's own"
    )
    drawing.add_argument(
        "--hints", type=str | None, help="a file of hints, or a folder of <sketch>_hints.png or .json"
    )
    drawing.add_argument(
        "--mask",
        type=str | None,
        help="where the object is: a file, a folder of <sketch>_mask.png, outline to fill the drawing's own, "
        "or model to leave it to the model; null is its opacity if that tells, else outline",
    )
    drawing.add_argument(
        "--size",
        type=int | None,
        help="longer side of the map in pixels; null is the drawing's, 1024 of an SVG",
    )
    sheets = parser.add_argument_group("Several drawings in one file")
    sheets.add_argument("--sheet", type=str | None, help="a sprite sheet: columns x rows, such as 4x3")
    sheets.add_argument(
        "--split",
        type=Literal["auto"] | None,
        help="auto finds a sheet's drawings: islands of opacity or of connected lines",
    )
    sheets.add_argument(
        "--atlas", type=str | None, help="a sheet's JSON by TexturePacker or Aseprite, or a folder of them"
    )
    sheets.add_argument(
        "--frame",
        type=Literal["own", "shared"] | None,
        help="what the model is shown: each drawing as large as can be, or the same square of all, so that "
        "what stands still stays so; null is shared for an animation, own else",
    )
    flags = {"alpha", "show_input"}
    parser.add_class_arguments(Outputs, skip=flags)
    parser.add_argument("--alpha", action="store_true", help="write the object's mask as alpha channel")
    parser.add_argument(
        "--show-input", action="store_true", help="write what the model saw, <sketch>_input.png"
    )
    return parser


def generate(settings: Namespace) -> int:
    """Paint and write the maps; return the exit code, 1 if some of several drawings could not be used.

    Raises:
        InputError: if nothing can be done: a setting or the only drawing cannot be used.
    """
    decoding.start()  # while the model is loaded
    check_size(settings.size)
    packing = Packing(settings.sheet, settings.split, settings.atlas)
    if packing.given and settings.size is not None:
        raise InputError("a sheet keeps its packing, and so its size; leave --size out.")
    outputs = Outputs(**{field.name: getattr(settings, field.name) for field in fields(Outputs)})
    content = (
        sys.stdin.buffer.read(MOST_BYTES + 1) if STDIN in settings.sketches and not settings.dry_run else None
    )
    files = find_files(settings.sketches, outputs.ending, settings.hints, settings.mask, content)
    jobs = plan(files, Path(settings.output), outputs.ending, list(outputs.others()))
    path = find_model(settings.model)
    if settings.dry_run:
        for job in jobs:
            extras = [f" with {each}" for each in (job.files.hints, job.files.mask) if isinstance(each, Path)]
            print(f"{job.files.drawing}{''.join(extras)} -> {job.target}")
        return 0
    _one_thread_each()
    painter = Painter(OnnxBackend(path, threads=1))
    work = JobPainter(painter, outputs, settings.size, packing, settings.frame)
    together = settings.frame == "shared" and len(jobs) > 1 and not packing.given
    written = work.together(jobs) if together else stream(jobs, work)
    failed = 0
    with _progress(len(jobs)) as advance:
        for job, outcome in written:
            if isinstance(outcome, Exception):
                sentence = _sentence(job, outcome)
                if len(jobs) == 1:
                    raise sentence from outcome
                failed += 1
                print(f"normalgan: {one_line(str(sentence))}", file=sys.stderr)
            elif outcome.warning:
                print(
                    one_line(f"normalgan: warning: {job.files.drawing}: {outcome.warning}."), file=sys.stderr
                )
            advance()
            if not isinstance(outcome, Exception):
                print(outcome.target)
    if failed:
        print(f"normalgan: {failed} of {len(jobs)} sketches could not be used.", file=sys.stderr)
    return 1 if failed else 0


def _one_thread_each() -> None:
    """Let OpenCV compute in the thread that calls it: drawings share the cores, not the parts of one."""
    import cv2

    cv2.setNumThreads(1)


def _sentence(job: Job, error: Exception) -> InputError:
    """Return an error in a sentence that names the drawing; raise it again if it is a mistake of ours."""
    if isinstance(error, OSError):
        return unwritable(f"the normal map cannot be written to {job.target}: {error.strerror}.", error)
    if not isinstance(error, InputError):
        raise error
    return named(job.files.drawing, error)


@contextmanager
def _progress(total: int) -> Iterator[Callable[[], None]]:
    """Give what moves a bar on standard error on; there is none for one drawing, or if nobody watches."""
    if total < 2 or not sys.stderr.isatty():
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True)) as progress:
        task = progress.add_task("painting", total=total)
        yield lambda: progress.advance(task)
