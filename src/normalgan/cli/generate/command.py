"""normalgan generate: predict normal maps for drawings with an ONNX model, without torch."""

import math
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from jsonargparse import Namespace

from normalgan import decoding
from normalgan.cli.generate.batch import DrawingBatch, Found
from normalgan.cli.generate.options import build_parser, engine_of
from normalgan.cli.parsing.light_parser import refuse_empty
from normalgan.errors import InputError, tell
from normalgan.inference.composites.packing import Packing
from normalgan.inference.jobs.clashes import without_clashes, without_twins
from normalgan.inference.jobs.plan import (
    STDIN,
    STDOUT,
    check_writable,
    find_many,
    format_of,
    is_file_name,
    plan,
    plan_file,
)
from normalgan.inference.jobs.watching import Watcher
from normalgan.inference.jobs.writing import Writer
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.outputs.output_set import Outputs, outputs_of
from normalgan.inference.predict_job import Destinations
from normalgan.inference.predictor import Predictor
from normalgan.inference.reading.drawings import MOST_BYTES
from normalgan.ranges import OutOfRangeError
from normalgan.weights.shipped import find_model


def run(arguments: list[str]) -> int:
    """Predict and write the maps; return the exit code, which is 1 if some of several drawings failed.

    Raises:
        InputError: if a setting or the only drawing is invalid.
    """
    parser = build_parser(engine_of(arguments))
    settings = parser.parse_args(arguments)
    refuse_empty(settings, "output", "mask", "hints", "atlas", "tileset", "explain")
    decoding.start()  # starts up while the model is loaded
    packing = _packing(settings)
    _check_explained(settings, packing)
    holes = _points(settings.hole or ())
    outputs = _outputs(settings)
    piped = _Piped() if settings.output == STDOUT else None
    content = (
        sys.stdin.buffer.read(MOST_BYTES + 1) if STDIN in settings.sketches and not settings.dry_run else None
    )
    single = len(settings.sketches) == 1 and (
        STDIN in settings.sketches or Path(settings.sketches[0]).is_file()
    )
    destinations = Destinations(outputs, packing, settings.layers, mixed=not single)
    find = partial(_find, settings, destinations, content)
    found = find()
    jobs, wrong = found.jobs, [*found.missing, *found.clashing]
    if wrong and not jobs:
        *others, last = wrong
        for other in others:
            tell(other)
        raise last
    if piped is not None and len(jobs) > 1:  # refused before anything is predicted
        raise _not_one(len(jobs))
    if holes and len(jobs) > 1:
        raise InputError(f"a hole is a point of one drawing, but there are {len(jobs)}; name one.")
    path = find_model(settings.model, [".onnx"])
    if piped is None:
        check_writable(jobs)
    writer = Writer(outputs) if piped is None else Writer(outputs, piped)
    batch = DrawingBatch(settings, writer, destinations, holes)
    for each in (*found.left_out, *wrong):
        tell(each)
    # Created before the first prediction, so that drawings saved during it are predicted again.
    watcher = Watcher(batch.read(jobs) if settings.watch else {})
    skips = settings.skip_existing and piped is None
    lacking = batch.without_existing(jobs) if skips else jobs
    if settings.dry_run:
        return 1 if batch.list_jobs(lacking) + len(wrong) else 0
    # Drawings with one frame and one scale are predicted together, even if most of their files exist.
    jobs = jobs if lacking and batch.share_frame else lacking
    _one_thread_each()
    predictor = Predictor(OnnxBackend(path, threads=1))
    batch.predict(predictor, jobs, alone=len(jobs) == 1 and not wrong and not settings.watch, keep=skips)
    if settings.watch:
        batch.watch(predictor, watcher, find, found)
    if piped is not None:
        piped.release()
    return batch.code(len(jobs), len(wrong))


def _packing(settings: Namespace) -> Packing:
    """Return the packing that the settings describe.

    Raises:
        InputError: if the settings contradict each other.
    """
    packed = settings.sheet or settings.split or settings.atlas or settings.tileset
    if settings.tile and (packed or settings.layers):
        raise InputError(
            "--tile repeats a whole drawing; omit --sheet, --split, --atlas, --tileset and --layers."
        )
    if settings.tileset and settings.frame == "shared":
        raise InputError("--tileset shows the model each tile with its neighbours; omit --frame shared.")
    if settings.tile and settings.frame == "shared":
        raise InputError("--tile shows the model each drawing with its repeats; omit --frame shared.")
    if settings.form and settings.tileset:
        raise InputError("--form needs an object with an edge, so it does not work with --tileset.")
    if settings.form and settings.hints:
        raise InputError("--form overrides hints; use only one of the two.")
    if settings.pixel_art and settings.size is not None:
        raise InputError("--pixel-art keeps the drawing's own pixels, and therefore its size; omit --size.")
    if settings.layers and packed:
        raise InputError(
            "--layers predicts each layer as a whole; omit --sheet, --split, --atlas and --tileset."
        )
    return Packing(settings.sheet, settings.split, settings.atlas, settings.tileset)


def _check_explained(settings: Namespace, packing: Packing) -> None:
    """Raise `InputError` if options about the mask contradict other options."""
    whole = settings.layers or settings.tile or settings.frame == "shared"
    if settings.hole and (packing.tileset or whole):
        raise InputError(
            "--hole is about the mask of a single drawing; omit --tileset, --layers, --tile and "
            "--frame shared."
        )
    given = [
        option for option, value in (("--explain", settings.explain), ("--single", settings.single)) if value
    ]
    if given and (packing.given or whole):
        raise InputError(
            f"{given[0]} is about the mask of a single drawing; omit --sheet, --split, --atlas, --tileset, "
            "--layers, --tile and --frame shared."
        )
    if settings.explain is not None and Path(settings.explain).is_file():
        raise InputError(f"--explain {settings.explain} is a file; name a folder.")


def _outputs(settings: Namespace) -> Outputs:
    """Return the outputs to write.

    Raises:
        InputError: if the settings contradict each other.
    """
    output = Path(settings.output)
    form = format_of(output, settings.format) if is_file_name(output) else settings.format
    try:
        outputs = outputs_of({**settings.as_dict(), "format": form or "png"})
    except OutOfRangeError as error:
        raise InputError(f"--{error.setting.replace('_', '-')} {error.verdict}") from None
    if settings.watch and outputs.whole_batch:
        raise InputError("--height-scale batch needs all drawings at once, unlike --watch; give pixels.")
    if settings.output == STDOUT and outputs.other_endings:
        raise InputError("standard output only holds the map; use -o with a folder for other outputs.")
    if settings.output == STDOUT and (settings.watch or settings.dry_run):
        raise InputError("standard output holds one map; --watch and --dry-run need a folder (-o).")
    return outputs


def _points(given: Sequence[str]) -> list[tuple[float, float]]:
    """Return x and y of each point.

    Raises:
        InputError: if a text is not a point.

    >>> _points(["12,40.5"])
    [(12.0, 40.5)]
    """
    points = []
    for each in given:
        try:
            x, y = map(float, each.split(","))
        except ValueError:
            x = y = math.nan
        if not math.isfinite(x) or not math.isfinite(y):
            raise InputError(
                f"--hole {each} is not a point; give x,y in pixels of the drawing, such as --hole 120,80."
            )
        points.append((x, y))
    return points


def _find(settings: Namespace, destinations: Destinations, content: bytes | None) -> Found:
    """Return the drawings that a command names."""
    folder, outputs, packing = Path(settings.output), destinations.outputs, destinations.packing
    files, missing = find_many(
        settings.sketches,
        outputs.ending,
        settings.hints,
        settings.mask,
        content,
        settings.recursive,
        folder,
        may_be_empty=settings.watch,
    )
    files, left_out = without_twins(files, settings.layers)
    others = outputs.other_endings
    also_read = [path for each in files for path in packing.companions(each.drawing, each.below)]
    also_read += [Path(settings.model)] if settings.model else []
    if is_file_name(folder):
        jobs = [plan_file(files, folder, others, also_read)] if files else []
        return Found(jobs, missing, [], left_out)
    jobs, clashing = without_clashes(
        plan(files, folder, outputs.ending, others, may_clash=True, also_read=also_read), destinations.written
    )
    return Found(jobs, missing, clashing, left_out)


class _Piped:
    """A sink that writes a single map to standard output."""

    def __init__(self) -> None:
        self._files: list[bytes] = []

    def __call__(self, _: Path, content: bytes) -> None:
        """Hold a file until `release`."""
        self._files.append(content)

    def release(self) -> None:
        """Write the map.

        Raises:
            InputError: if there is not exactly one map.
        """
        if len(self._files) != 1:
            raise _not_one(len(self._files))
        sys.stdout.buffer.write(self._files[0])
        sys.stdout.flush()


def _not_one(maps: int) -> InputError:
    return InputError(f"standard output holds one map, but there are {maps}; give -o a folder.")


def _one_thread_each() -> None:
    """Make OpenCV single-threaded, because the drawings are already processed in parallel."""
    import cv2

    cv2.setNumThreads(1)
