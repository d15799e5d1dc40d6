"""Jobs: which files are read for each drawing, and which are written."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from normalgan.drawings import find_drawings
from normalgan.errors import InputError
from normalgan.painting.hint_files import find_hints
from normalgan.painting.masks import find_mask

STDIN = "-"
OUTLINE, MODEL = "outline", "model"
"""What a mask may be in place of a file."""
COMPANIONS = ("_hints", "_mask", "_input", "_preview", "_height", "_relief")
"""What is named so after a drawing lies beside it and is none."""


@dataclass(frozen=True)
class Job:
    """One drawing.

    Args:
        drawing: its file, or what to call standard input.
        content: what was read from standard input.
        target: the normal map.
        hints: the file of its hints.
        mask: the file of its mask.
    """

    drawing: Path
    content: bytes | None
    target: Path
    hints: Path | None
    mask: Path | None

    def beside(self, ending: str) -> Path:
        """Return the name of something else that is written for the drawing, such as ``_input.png``."""
        return self.target.with_name(self.drawing.stem + ending)


def plan(
    sketches: Sequence[str],
    folder: Path,
    ending: str,
    hints: str | None = None,
    mask: str | None = None,
    content: bytes | None = None,
    others: Sequence[str] = (),
) -> list[Job]:
    """Return the jobs of a command.

    Args:
        sketches: files, folders and globs; ``-`` is ``content``.
        folder: where everything goes.
        ending: of a normal map's name, such as ``_normal.png``.
        hints: a file or a folder.
        mask: a file, a folder, or one of `OUTLINE` and `MODEL`.
        content: what standard input holds.
        others: endings of what else is written.

    Raises:
        InputError: if something is missing, or two files would have one name.
    """
    named = [each for each in sketches if each != STDIN]
    suffix = Path(ending).stem
    companions = (*COMPANIONS, *([suffix] if suffix else []))
    drawings = find_drawings(named, ending, companions) if named else []
    if STDIN in sketches:
        drawings.append(Path("stdin"))
    jobs = []
    mask_files = None if mask in {OUTLINE, MODEL, None} else _source(mask, "mask", len(drawings))
    hint_files = None if hints is None else _source(hints, "hints", len(drawings))
    for drawing in drawings:
        own = content if drawing == Path("stdin") and STDIN in sketches else None
        jobs.append(
            Job(
                drawing,
                own,
                folder / f"{drawing.stem}{ending}",
                None if hint_files is None else find_hints(drawing, hint_files),
                None if mask_files is None else find_mask(drawing, mask_files),
            )
        )
    if hint_files is not None and not any(job.hints for job in jobs):
        raise InputError(
            f"{hints} holds no hints for any sketch; they are named <sketch>_hints.png or .json."
        )
    if mask_files is not None and not any(job.mask for job in jobs):
        raise InputError(f"{mask} holds no mask for any sketch; they are named <sketch>_mask.png.")
    _check_names(jobs, others)
    return jobs


def _source(named: str | None, kind: str, drawings: int) -> Path:
    path = Path(named or "")
    if not path.exists():
        raise InputError(f"there is no file or folder {path} for the {kind}.")
    if path.is_file() and drawings > 1:
        raise InputError(f"one file of {kind}, {path}, cannot serve {drawings} sketches; name a folder.")
    return path


def _check_names(jobs: Sequence[Job], others: Sequence[str]) -> None:
    """Raise `InputError` if something would be written over a sketch, its companions, or twice."""
    read = {path.resolve() for job in jobs for path in (job.drawing, job.hints, job.mask) if path is not None}
    written: set[Path] = set()
    for path in _written(jobs, others):
        if path.resolve() in read:
            raise InputError(
                f"{path} is read and would be written over; give another folder (-o) or --suffix."
            )
        if path.resolve() in written:
            raise InputError(f"{path} would be written twice; rename a sketch, or give another --suffix.")
        written.add(path.resolve())


def _written(jobs: Sequence[Job], others: Sequence[str]) -> Iterator[Path]:
    for job in jobs:
        yield job.target
        yield from (job.beside(ending) for ending in others)
