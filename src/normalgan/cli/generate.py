"""normalgan generate: from drawings to normal maps by a model as ONNX, without torch."""

import math
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from jsonargparse import Namespace

from normalgan import decoding
from normalgan.cli.generate_parser import as_shell_means, build_parser, engine_of
from normalgan.errors import InputError, RunError, one_line, unwritable, with_subject
from normalgan.inference.composites.packing import Packing
from normalgan.inference.jobs.clashes import without_clashes, without_twins
from normalgan.inference.jobs.plan import (
    STDIN,
    STDOUT,
    Job,
    check_writable,
    companions_of,
    find_many,
    format_of,
    is_file_name,
    plan,
    plan_file,
)
from normalgan.inference.jobs.watching import Watcher
from normalgan.inference.jobs.writing import Held, Writer
from normalgan.inference.network.onnx_backend import OnnxBackend, find_model
from normalgan.inference.outputs.outputs import Outputs, outputs_of
from normalgan.inference.parallel import stream
from normalgan.inference.predict_job import JobPredictor, target_of, written_for
from normalgan.inference.predictor import Predictor
from normalgan.inference.reading.drawings import MOST_BYTES, without_companions
from normalgan.inference.sprites import Sprite
from normalgan.progress import progress_bar

__all__ = ["POLL_SECONDS", "generate", "run"]

POLL_SECONDS = 0.5
"""Seconds between two looks at the watched folders."""


def run(arguments: list[str]) -> int:
    """Predict the named drawings and return the exit code.

    Raises:
        InputError: if an argument cannot be used.
    """
    parser = build_parser(engine_of(arguments))
    options = [option for action in parser._actions for option in action.option_strings]
    return generate(parser.parse_args(as_shell_means(arguments, options)))


def generate(settings: Namespace) -> int:
    """Predict and write the maps; return the exit code, 1 if some of several drawings could not be used.

    Raises:
        InputError: if nothing can be done: a setting or the only drawing cannot be used.
    """
    decoding.start()  # while the model is loaded
    packing = _packing(settings)
    _check_explained(settings, packing)
    outputs = _outputs(settings)
    piped = _Piped() if settings.output == STDOUT else None
    content = (
        sys.stdin.buffer.read(MOST_BYTES + 1) if STDIN in settings.sketches and not settings.dry_run else None
    )

    def find() -> _Found:
        return _find(settings, outputs, packing, content)

    found = find()
    jobs, wrong = found.jobs, [*found.missing, *found.clashing]
    if wrong and not jobs:
        raise wrong[0]
    if piped is not None and len(jobs) > 1:  # refused before they are predicted
        raise _not_one(len(jobs))
    if settings.hole and len(jobs) > 1:
        raise InputError(f"a hole is a point of one drawing, but there are {len(jobs)}; name one.")
    path = find_model(settings.model)
    if piped is None:
        check_writable(jobs)
    writer = Writer(outputs) if piped is None else Writer(outputs, piped)
    batch = _Batch(settings, writer, packing, wrong, found.left_out)
    # Before the first prediction, so that drawings saved meanwhile are predicted again.
    watcher = Watcher(batch.read(jobs) if settings.watch else {})
    if settings.skip_existing and piped is None:
        jobs = batch.without_existing(jobs)
    if settings.dry_run:
        return batch.list_jobs(jobs)
    _one_thread_each()
    predictor = Predictor(OnnxBackend(path, threads=1))
    batch.predict(predictor, jobs, alone=len(jobs) == 1 and not wrong and not settings.watch)
    if settings.watch:
        batch.watch(predictor, watcher, find, found)
    if piped is not None:
        piped.release()
    return batch.code(len(jobs) + len(wrong))


def _packing(settings: Namespace) -> Packing:
    """Return how drawings are found in a file.

    Raises:
        InputError: if its settings contradict each other.
    """
    packed = settings.sheet or settings.split or settings.atlas or settings.tileset
    if settings.tile and (packed or settings.layers):
        raise InputError(
            "--tile repeats a whole drawing; leave --sheet, --split, --atlas, --tileset and --layers out."
        )
    if settings.tileset and settings.frame == "shared":
        raise InputError("--tileset shows the model each tile with its neighbours; leave --frame shared out.")
    if settings.tile and settings.frame == "shared":
        raise InputError("--tile shows the model each drawing with its repeats; leave --frame shared out.")
    if settings.pixel_art and settings.size is not None:
        raise InputError("--pixel-art keeps the drawing's own pixels, and so its size; leave --size out.")
    if settings.layers and packed:
        raise InputError(
            "--layers predicts each layer as a whole; leave --sheet, --split, --atlas and --tileset out."
        )
    return Packing(settings.sheet, settings.split, settings.atlas, settings.tileset)


def _points(given: Sequence[str]) -> list[tuple[float, float]]:
    """Return x and y of each point.

    Raises:
        InputError: if one is not a point.

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


def _check_explained(settings: Namespace, packing: Packing) -> None:
    """Raise `InputError` if options of the mask contradict other options."""
    given = [
        option
        for option, value in (
            ("--hole", settings.hole),
            ("--explain", settings.explain),
            ("--single", settings.single),
        )
        if value
    ]
    if given and (packing.given or settings.layers or settings.tile or settings.frame == "shared"):
        raise InputError(
            f"{given[0]} is about the mask of a single drawing; leave --sheet, --split, --atlas, --tileset, "
            "--layers, --tile and --frame shared out."
        )
    _points(settings.hole or ())
    if settings.explain is not None and Path(settings.explain).is_file():
        raise InputError(f"--explain {settings.explain} is a file; name a folder.")


def _outputs(settings: Namespace) -> Outputs:
    """Return the outputs to write.

    Raises:
        InputError: if its settings contradict each other.
    """
    output = Path(settings.output)
    form = format_of(output, settings.format) if is_file_name(output) else settings.format
    outputs = outputs_of({**settings.as_dict(), "format": form or "png"})
    if settings.watch and outputs.whole_batch:
        raise InputError("--height-scale batch needs all drawings, and --watch never has them; give pixels.")
    if settings.output == STDOUT and outputs.beside:
        raise InputError("standard output holds the map alone; give -o a folder for the rest.")
    if settings.output == STDOUT and (settings.watch or settings.dry_run):
        raise InputError("standard output holds one map; --watch and --dry-run need a folder (-o).")
    return outputs


class _Batch:
    """How the drawings of a command are processed."""

    def __init__(
        self,
        settings: Namespace,
        writer: Writer,
        packing: Packing,
        wrong: Sequence[InputError],
        left_out: Sequence[str],
    ) -> None:
        self._settings, self._writer, self._packing = settings, writer, packing
        self._outputs = writer.outputs
        self._failed, self._partial = len(wrong), 0
        self._held: list[Held] = []
        for each in (*left_out, *wrong):
            print(f"normalgan: {one_line(str(each))}", file=sys.stderr)

    def without_existing(self, jobs: Sequence[Job]) -> list[Job]:
        """Return the jobs that have no map yet; say how many have."""
        left = [job for job in jobs if not self._has_map(job)]
        if len(left) < len(jobs):
            print(
                f"normalgan: {len(jobs) - len(left)} of {len(jobs)} sketches have a map already.",
                file=sys.stderr,
            )
        return left

    def list_jobs(self, jobs: Sequence[Job]) -> int:
        """Print what would be read and written, and return the exit code."""
        for job in jobs:
            extras = [f" with {each}" for each in job.files.beside]
            try:
                target = self._target(job)
                there = next(each for each in target.absolute().parents if each.is_dir())
                with suppress(FileNotFoundError):
                    (there / target.name).lstat()  # refuses a name that is too long
                print(f"{job.files.drawing}{''.join(extras)} -> {target}")
            except (InputError, OSError) as error:
                self._failed += 1
                print(f"normalgan: {one_line(str(_sentence(job, error)))}", file=sys.stderr)
        return 1 if self._failed else 0

    def predict(self, predictor: Predictor, jobs: Sequence[Job], alone: bool = False) -> None:
        """Predict drawings, and print the outcome of each.

        Args:
            predictor: the network.
            jobs: the drawings.
            alone: whether an error of a drawing is raised, because it is the only one.
        """
        settings = self._settings
        work = JobPredictor(
            predictor,
            self._writer,
            size=settings.size,
            packing=self._packing,
            frame=settings.frame,
            strength=settings.strength,
            layers=settings.layers,
            tile=settings.tile,
            single=settings.single,
            holes=_points(settings.hole or ()),
            explain=None if settings.explain is None else Path(settings.explain),
            sprite=Sprite(settings.detail, settings.pixel_art),
        )
        written = work.together(jobs) if self._share_frame and len(jobs) > 1 else stream(jobs, work)
        watched = len(jobs) > 1 and sys.stderr.isatty()
        with progress_bar("predicting", len(jobs), "drawings", shown=watched) as advance:
            for job, outcome in written:
                advance(1)
                if isinstance(outcome, Exception):
                    sentence = _sentence(job, outcome)
                    if alone:
                        raise sentence from outcome
                    self._failed += 1
                    print(f"normalgan: {one_line(str(sentence))}", file=sys.stderr)
                    continue
                self._held += outcome.held
                self._partial += outcome.partial
                if outcome.warning:
                    warning = f"normalgan: warning: {job.files.drawing}: {outcome.warning}."
                    print(one_line(warning), file=sys.stderr)
                if outcome.note:
                    print(one_line(f"normalgan: {job.files.drawing}: {outcome.note}."), file=sys.stderr)
                if settings.output != STDOUT:
                    print(outcome.target, flush=self._settings.watch)

    def watch(
        self,
        predictor: Predictor,
        watcher: Watcher,
        find: Callable[[], "_Found"],
        found: "_Found",
    ) -> None:
        """Predict drawings whenever they are saved, until Ctrl-C; those that share a frame all together.

        Raises:
            RunError: if a folder that was named was removed.
        """
        folders = [Path(word) for word in self._settings.sketches if Path(word).is_dir()]
        print("normalgan: watching; Ctrl-C ends it.", file=sys.stderr, flush=True)
        printed, known = set(found.notices), set[Path]()
        while True:
            time.sleep(POLL_SECONDS)
            for place in folders:
                if not place.exists():
                    raise RunError(f"the folder {place} that is watched is gone.")
            jobs, now = {}, set[str]()
            try:
                found = find()
                jobs, now = {job.files.drawing: job for job in found.jobs}, set(found.notices)
            except InputError as error:  # such as a map that would be written over a new drawing
                now = {str(error)}
            for each in sorted(now - printed):
                print(f"normalgan: {one_line(each)}", file=sys.stderr, flush=True)
            printed = now
            # The map of a drawing that was deleted or renamed is not a drawing either.
            known |= set(jobs)
            kept = set(without_companions(sorted(known), companions_of(self._outputs.ending)))
            jobs = {path: job for path, job in jobs.items() if path in kept}
            saved = watcher.saved(self.read(jobs.values()))
            if saved:
                try:
                    self.predict(
                        predictor, [*jobs.values()] if self._share_frame else [jobs[each] for each in saved]
                    )
                except InputError as error:  # such as frames of several sizes, until all are saved
                    print(f"normalgan: {one_line(str(error))}", file=sys.stderr, flush=True)

    def read(self, jobs: Iterable[Job]) -> dict[Path, list[Path]]:
        """Return the drawings, each with its hints, mask and other files."""
        files = [job.files for job in jobs]
        return {
            each.drawing: [*each.beside, *self._packing.beside(each.drawing, each.below)] for each in files
        }

    @property
    def _share_frame(self) -> bool:
        """Whether drawings in separate files share a frame."""
        return self._settings.frame == "shared" and not self._packing.given and not self._settings.layers

    def code(self, total: int) -> int:
        """Write outputs that needed all drawings, report how many failed, and return the exit code."""
        self._writer.write_held(self._held)
        if self._failed:
            print(f"normalgan: {self._failed} of {total} sketches could not be used.", file=sys.stderr)
        if self._partial:
            print(f"normalgan: {self._partial} of {total} sketches are incomplete.", file=sys.stderr)
        return 1 if self._failed or self._partial else 0

    def _target(self, job: Job) -> Path:
        return target_of(job, self._outputs, self._packing, self._settings.layers)

    def _has_map(self, job: Job) -> bool:
        try:
            return self._target(job).exists()
        except InputError:
            return False  # the error is raised when it is predicted


@dataclass(frozen=True)
class _Found:
    """The drawings that a command names, and those that it cannot use.

    Args:
        jobs: the drawings to predict.
        missing: an error for each argument without a drawing.
        clashing: drawings that would be written to one file.
        left_out: warnings about layered files and their exports.
    """

    jobs: list[Job]
    missing: list[InputError]
    clashing: list[InputError]
    left_out: list[str]

    @property
    def notices(self) -> list[str]:
        """The lines to print while a folder is watched; a missing file may still come, so none is for it."""
        return [*self.left_out, *map(str, self.clashing)]


def _find(settings: Namespace, outputs: Outputs, packing: Packing, content: bytes | None) -> _Found:
    """Return the inputs that a command names."""
    folder = Path(settings.output)
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
    others = outputs.beside
    also_read = [path for each in files for path in packing.beside(each.drawing, each.below)]
    also_read += [Path(settings.model)] if settings.model else []
    if is_file_name(folder):
        jobs = [plan_file(files, folder, others, also_read)] if files else []
        return _Found(jobs, missing, [], left_out)
    jobs, clashing = without_clashes(
        plan(files, folder, outputs.ending, others, may_clash=True, also_read=also_read),
        lambda job: written_for(job, outputs, packing, settings.layers),
    )
    return _Found(jobs, missing, clashing, left_out)


class _Piped:
    """Standard output as the sink of a single map, checked to be the only one."""

    def __init__(self) -> None:
        self._files: list[bytes] = []

    def __call__(self, _: Path, content: bytes) -> None:
        """Take a file."""
        self._files.append(content)

    def release(self) -> None:
        """Write the map.

        Raises:
            InputError: if there is none, or more than one.
        """
        if len(self._files) != 1:
            raise _not_one(len(self._files))
        sys.stdout.buffer.write(self._files[0])
        sys.stdout.flush()


def _not_one(maps: int) -> InputError:
    return InputError(f"standard output holds one map, but there are {maps}; give -o a folder.")


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
    return with_subject(job.files.drawing, error)
