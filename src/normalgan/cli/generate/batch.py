"""DrawingBatch: predict the drawings of normalgan generate once, or whenever they are saved."""

import sys
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from jsonargparse import Namespace

from normalgan.errors import InputError, RunError, printable, tell, unwritable, with_subject
from normalgan.inference.forms import parse_form
from normalgan.inference.jobs.plan import STDOUT, Job, companions_of
from normalgan.inference.jobs.watching import Watcher
from normalgan.inference.jobs.writing import MissingFiles, Writer
from normalgan.inference.parallel import stream
from normalgan.inference.predict_job import Destinations, JobPredictor
from normalgan.inference.predictor import Predictor
from normalgan.inference.reading.drawings import without_companions
from normalgan.inference.sprites import Sprite
from normalgan.progress import progress_bar

_POLL_SECONDS = 0.5
"""Seconds between two checks of the watched folders."""


@dataclass(frozen=True)
class Found:
    """The drawings that a command names, and errors about unusable ones.

    Args:
        jobs: the drawings to predict.
        missing: an error for each argument that matches no drawing.
        clashing: an error for each drawing that would be written to the same file as another.
        left_out: messages about layered files or their exports that are skipped.
    """

    jobs: list[Job]
    missing: list[InputError]
    clashing: list[InputError]
    left_out: list[str]

    @property
    def notices(self) -> list[str]:
        """The messages to print while watching, without missing files, which may still arrive."""
        return [*self.left_out, *map(str, self.clashing)]


class DrawingBatch:
    """Processes the drawings of a command.

    Args:
        settings: the arguments of `normalgan generate`.
        writer: writes the outputs.
        destinations: the files of each job.
        holes: x and y of points whose regions are flipped between object and hole.
    """

    def __init__(
        self,
        settings: Namespace,
        writer: Writer,
        destinations: Destinations,
        holes: Sequence[tuple[float, float]] = (),
    ) -> None:
        self._settings, self._writer, self._holes = settings, writer, holes
        self._destinations, self._packing = destinations, destinations.packing
        self._form = None if settings.form is None else parse_form(settings.form)
        self._failed = self._partial = 0

    def without_existing(self, jobs: Sequence[Job]) -> list[Job]:
        """Return the jobs that lack a file; print the number of those that have all."""
        written = ((job, self._destinations.written(job)) for job in jobs)
        left = [job for job, files in written if not files or not all(each.exists() for each in files)]
        if len(left) < len(jobs):
            tell(f"{len(jobs) - len(left)} of {len(jobs)} sketches already have a map.")
        return left

    def list_jobs(self, jobs: Sequence[Job]) -> int:
        """Print what would be read and written, and return the number of unusable drawings."""
        failed = 0
        for job in jobs:
            extras = [f" with {each}" for each in job.files.companions]
            try:
                target = self._destinations.target(job)
                there = next(each for each in target.absolute().parents if each.is_dir())
                with suppress(FileNotFoundError):
                    (there / target.name).lstat()  # raises an error if the name is too long
            except (InputError, OSError) as error:
                failed += 1
                tell(_sentence(job, error))
            else:
                written = ", ".join(map(str, self._destinations.written(job)))
                print(printable(f"{job.files.drawing}{''.join(extras)} -> {written}"))
        return failed

    def predict(
        self, predictor: Predictor, jobs: Sequence[Job], alone: bool = False, keep: bool = False
    ) -> None:
        """Predict drawings, and print the result of each.

        Args:
            predictor: the network.
            jobs: the drawings.
            alone: whether there is only one drawing, so that its error is raised instead of printed.
            keep: whether files that exist are kept, and only the missing ones are written.
        """
        settings = self._settings
        missing = MissingFiles(self._writer.sink)
        if keep:
            self._writer = replace(self._writer, sink=missing)
        work = JobPredictor(
            predictor,
            self._destinations,
            self._writer,
            size=settings.size,
            frame=settings.frame,
            strength=settings.strength,
            tile=settings.tile,
            single=settings.single,
            holes=self._holes,
            explain=None if settings.explain is None else Path(settings.explain),
            sprite=Sprite(settings.detail, settings.pixel_art, self._form),
        )
        written = work.together(jobs) if self.share_frame and len(jobs) > 1 else stream(jobs, work)
        watched = len(jobs) > 1 and sys.stderr.isatty()
        with progress_bar("predicting", len(jobs), "drawings", shown=watched) as advance:
            for job, outcome in written:
                advance(1)
                if isinstance(outcome, Exception):
                    sentence = _sentence(job, outcome)
                    if alone:
                        raise sentence from outcome
                    self._failed += 1
                    tell(sentence)
                    continue
                self._partial += outcome.partial
                if outcome.warning:
                    tell(f"warning: {job.files.drawing}: {outcome.warning}.")
                if outcome.note:
                    tell(f"{job.files.drawing}: {outcome.note}.")
                if settings.output != STDOUT:
                    for each in outcome.maps:
                        if each not in missing.kept:
                            print(printable(each), flush=self._settings.watch)
        if keep and settings.watch:  # a drawing that is saved later gets a new map
            self._writer = replace(self._writer, sink=missing.sink)

    def watch(self, predictor: Predictor, watcher: Watcher, find: Callable[[], Found], found: Found) -> None:
        """Predict drawings whenever they are saved, until Ctrl-C; drawings that share a frame all at once.

        Raises:
            RunError: if a named folder was removed.
        """
        folders = [Path(word) for word in self._settings.sketches if Path(word).is_dir()]
        tell("watching; Ctrl-C stops it.")
        printed, known = set(found.notices), set[Path]()
        while True:
            time.sleep(_POLL_SECONDS)
            for place in folders:
                if not place.exists():
                    raise RunError(f"the watched folder {place} no longer exists.")
            jobs, now = {}, set[str]()
            try:
                found = find()
                jobs, now = {job.files.drawing: job for job in found.jobs}, set(found.notices)
            except InputError as error:  # for example, a map would overwrite a new drawing
                now = {str(error)}
            for each in sorted(now - printed):
                tell(each)
            printed = now
            # The maps of deleted or renamed drawings are not drawings either.
            known |= set(jobs)
            kept = set(without_companions(sorted(known), companions_of(self._destinations.outputs.ending)))
            jobs = {path: job for path, job in jobs.items() if path in kept}
            saved = watcher.saved(self.read(jobs.values()))
            if saved:
                try:
                    self.predict(
                        predictor, [*jobs.values()] if self.share_frame else [jobs[each] for each in saved]
                    )
                except InputError as error:  # for example, frames differ in size until all are saved
                    tell(error)

    def read(self, jobs: Iterable[Job]) -> dict[Path, list[Path]]:
        """Return the drawings, each with its other input files, such as hints and mask."""
        files = [job.files for job in jobs]
        return {
            each.drawing: [*each.companions, *self._packing.companions(each.drawing, each.below)]
            for each in files
        }

    @property
    def share_frame(self) -> bool:
        """Whether drawings in separate files are framed by one square, so that none is predicted alone."""
        return self._settings.frame == "shared" and not self._packing.given and not self._settings.layers

    def code(self, predicted: int, unusable: int) -> int:
        """Write the held outputs, print the number of failures, and return the exit code.

        Args:
            predicted: number of drawings that were passed to `predict`.
            unusable: number of drawings that were found unusable before.
        """
        self._writer.write_held()
        failed, total = self._failed + unusable, predicted + unusable
        if failed:
            tell(f"{failed} of {total} sketches could not be used.")
        if self._partial:
            tell(
                f"some frames or layers of {self._partial} of {total} sketches could not be used; "
                "the lines above name them."
            )
        return 1 if failed or self._partial else 0


def _sentence(job: Job, error: Exception) -> InputError:
    """Return an error as a message that names the drawing; re-raise errors that are bugs."""
    if isinstance(error, OSError):
        return unwritable(f"the normal map cannot be written to {job.target}: {error.strerror}.", error)
    if not isinstance(error, InputError):
        raise error
    return with_subject(job.files.drawing, error)
