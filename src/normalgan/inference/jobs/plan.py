"""Jobs: which files are read for each drawing, and which are written."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryFile
from typing import Literal

from normalgan.errors import InputError, unwritable
from normalgan.inference.jobs.folders import find_drawings, search
from normalgan.inference.mask.mask_files import ENDINGS as MASK_ENDINGS
from normalgan.inference.mask.mask_files import SOURCES, MaskSource
from normalgan.inference.outputs import OUTPUTS
from normalgan.inference.reading.drawings import SUFFIXES, find_companion
from normalgan.inference.reading.hint_files import ENDINGS as HINT_ENDINGS

__all__ = [
    "FILES",
    "STDIN",
    "STDOUT",
    "DrawingFiles",
    "Job",
    "check_writable",
    "companions_of",
    "find_files",
    "find_many",
    "format_of",
    "is_file_name",
    "overwritten",
    "plan",
    "plan_file",
]

STDIN = STDOUT = "-"
FILES: dict[str, Literal["png", "exr", "tiff"]] = {
    **{".png": "png", ".apng": "png", ".gif": "png", ".webp": "png"},
    **{".exr": "exr", ".tif": "tiff", ".tiff": "tiff"},
}
"""Endings of a map's file, and the format of each; GIF and WebP hold animations."""
_NO_MAPS = {
    *(each for each in SUFFIXES if each not in FILES),
    *(".avif", ".dds", ".hdr", ".jxl", ".ktx", ".ktx2", ".tga", ".avi", ".mov", ".mp4", ".webm", ".json"),
}
"""Endings that no output folder has: such a name means a file of a kind that is not written."""


@dataclass(frozen=True)
class DrawingFiles:
    """A drawing and what belongs to it.

    Args:
        drawing: its file, or a name for standard input.
        content: the content of standard input.
        hints: the file of its hints.
        mask: the file of its mask, or one of the sources of masks.
        below: the folder below the output that its map goes to.
    """

    drawing: Path
    content: bytes | None = None
    hints: Path | None = None
    mask: Path | MaskSource | None = None
    below: Path = Path()

    @property
    def beside(self) -> list[Path]:
        """The files that are read besides the drawing."""
        return [each for each in (self.hints, self.mask) if isinstance(each, Path)]


@dataclass(frozen=True)
class Job:
    """One drawing to predict.

    Args:
        files: what is read.
        target: the normal map.
        stem: stem of the names of all other outputs.
        exact: whether the user named the file of the map, so that its kind is settled.
    """

    files: DrawingFiles
    target: Path
    stem: str
    exact: bool = False

    def beside(self, ending: str) -> Path:
        """Return the name of another output of the drawing, such as ``_input.png``."""
        return self.target.with_name(self.stem + ending)

    def numbered(self, number: int, ending: str) -> "Job":
        """Return the job of one frame, counted from 1; ``ending`` is that of a map's name."""
        stem = f"{self.stem}_{number:04d}"
        return Job(self.files, self.target.with_name(stem + ending), stem)


def find_files(
    sketches: str | Sequence[str], hints: str | None = None, mask: str | None = None
) -> list[DrawingFiles]:
    """Return the named drawings, each with its hints and its mask; normal maps beside them are left out.

    Args:
        sketches: files, folders and globs.
        hints: a file or a folder.
        mask: a file, a folder, or one of the sources of masks.

    Raises:
        InputError: if something is missing.
    """
    drawings = find_drawings(sketches, "_normal.png", companions_of("_normal.png"))
    return _with_companions([DrawingFiles(drawing) for drawing in drawings], hints, mask)


def find_many(
    sketches: Sequence[str],
    ending: str,
    hints: str | None,
    mask: str | None,
    content: bytes | None,
    recursive: bool,
    folder: Path,
    may_be_empty: bool = False,
) -> tuple[list[DrawingFiles], list[InputError]]:
    """Return the named drawings, and the reasons why some names match none.

    Args:
        sketches: files, folders and globs; ``-`` is ``content``.
        ending: ending of a normal map's name; files that end so are not drawings.
        hints: as `find_files` has them.
        mask: as `find_files` has it.
        content: what standard input holds.
        recursive: search folders to the bottom.
        folder: where the maps go; it is not searched.
        may_be_empty: whether a folder may have no drawings.

    Raises:
        InputError: if a file of hints or of the mask is missing.
    """
    named = [each for each in sketches if each != STDIN]
    found, wrong = search(named, companions_of(ending), recursive, folder, may_be_empty)
    read = [DrawingFiles(drawing, below=below) for drawing, below in found.items()]
    if STDIN in sketches:
        read.append(DrawingFiles(Path("stdin"), content))
    return (_with_companions(read, hints, mask) if read else []), wrong


def companions_of(ending: str) -> tuple[str, ...]:
    """Return the files next to a drawing that are named after it and are not drawings.

    Args:
        ending: ending of a normal map's name, such as ``_normal.png``.
    """
    outputs = [Path(each).stem for kind in OUTPUTS for each in kind().endings]
    suffix = Path(ending).stem
    return ("_hints", "_mask", *outputs, *([suffix] if suffix else []))


def _with_companions(read: Sequence[DrawingFiles], hints: str | None, mask: str | None) -> list[DrawingFiles]:
    of_hints = _companions(read, hints, "hints", HINT_ENDINGS)
    of_masks: list[Path | MaskSource | None] = (
        [SOURCES[mask]] * len(read) if mask in SOURCES else [*_companions(read, mask, "mask", MASK_ENDINGS)]
    )
    found = zip(read, of_hints, of_masks, strict=True)
    return [replace(each, hints=own, mask=where) for each, own, where in found]


def plan(
    files: Sequence[DrawingFiles],
    folder: Path,
    ending: str,
    others: Sequence[str] = (),
    may_clash: bool = False,
    also_read: Sequence[Path] = (),
) -> list[Job]:
    """Return the jobs: the drawings to predict, and their outputs.

    Args:
        files: the drawings.
        folder: where everything goes.
        ending: ending of a normal map's name, such as ``_normal.png``.
        others: endings of the other outputs.
        may_clash: whether two drawings may go to one file, because the caller handles it.
        also_read: other files that are read, such as the model.

    Raises:
        InputError: if something that is read would be written over, or two files would have one name.
    """
    jobs = [
        Job(each, folder / each.below / f"{each.drawing.stem}{ending}", each.drawing.stem) for each in files
    ]
    _check_names(jobs, others, also_read, may_clash)
    return jobs


def is_file_name(output: Path) -> bool:
    """Return whether an output is the name of a map's file, and no folder.

    Raises:
        InputError: if it is the name of a file of a kind that is not written.
    """
    if output.is_dir():
        return False
    if output.suffix.lower() in _NO_MAPS:
        raise InputError(
            f"{output} is not a map's name, which ends in .png, .exr, .tif or .tiff, or if it moves in .gif, "
            ".webp or .apng; name such a file, or a folder (-o)."
        )
    return output.suffix.lower() in FILES


def format_of(target: Path, asked: str | None) -> Literal["png", "exr", "tiff"]:
    """Return the format of a map by the ending of its file.

    Args:
        target: the file.
        asked: the requested format, or None.

    Raises:
        InputError: if they disagree.
    """
    found = FILES[target.suffix.lower()]
    if asked not in {None, found}:
        raise InputError(f"{target} is not {asked}; name a file of that kind, or leave --format out.")
    return found


def plan_file(
    files: Sequence[DrawingFiles], target: Path, others: Sequence[str] = (), also_read: Sequence[Path] = ()
) -> Job:
    """Return the job of the one drawing whose map goes to a file of a given name; see `plan`.

    Raises:
        InputError: if there are several, or something that is read would be written over.
    """
    if len(files) != 1:
        raise InputError(f"{target} is one file, but there are {len(files)} sketches; name a folder (-o).")
    job = Job(files[0], target, target.stem, exact=True)
    _check_names([job], others, also_read)
    return job


def check_writable(jobs: Sequence[Job]) -> None:
    """Raise `InputError` if a map cannot be written to its place."""
    for target in (job.target for job in jobs if job.target.is_dir()):
        raise InputError(f"the normal map cannot be written to {target}: it is a folder.")
    for folder in {job.target.parent for job in jobs}:
        there = next(each for each in (folder, *folder.absolute().parents) if each.exists())
        try:
            # Only an attempt tells: permissions do not say that a disk is full or mounted read-only.
            with TemporaryFile(dir=there) as probe:
                probe.write(b"0")
        except OSError as error:
            raise unwritable(
                f"the normal map cannot be written to {folder}: {error.strerror}.", error
            ) from None


def overwritten(path: Path) -> InputError:
    """Return the error about an output that is one of the inputs."""
    return InputError(f"{path} is an input and would be overwritten; give another folder (-o) or --suffix.")


def _companions(
    read: Sequence[DrawingFiles], named: str | None, kind: str, endings: Sequence[str]
) -> list[Path | None]:
    """Return the file of hints or of the mask for each drawing, if there is one."""
    if named is None:
        return [None] * len(read)
    source = Path(named)
    if not source.exists():
        raise InputError(f"there is no file or folder {source} for the {kind}.")
    if source.is_file() and len(read) > 1:
        raise InputError(
            f"{source} holds the {kind} of one sketch, but there are {len(read)}; name a folder."
        )
    found = [find_companion(each.drawing, source, endings, each.below) for each in read]
    if not any(found):
        wanted = " or ".join(f"<sketch>{ending}" for ending in endings if ending.startswith("_"))
        raise InputError(f"{named} holds no {kind} for any sketch; they are named {wanted}.")
    return found


def _check_names(
    jobs: Sequence[Job], others: Sequence[str], also_read: Sequence[Path], may_clash: bool = False
) -> None:
    """Raise `InputError` if an input would be overwritten, or a file written twice.

    With ``may_clash``, only a file that one drawing would write twice is an error.
    """
    given = [(job.files.drawing, *job.files.beside) for job in jobs]
    read = {path.resolve() for each in (*given, also_read) for path in each}
    written: set[Path] = set()
    for job in jobs:
        if may_clash:
            written.clear()
        for path in (job.target, *(job.beside(ending) for ending in others)):
            if path.resolve() in read:
                raise overwritten(path)
            if path.resolve() in written:
                raise InputError(f"{path} would be written twice; rename a sketch, or give another --suffix.")
            written.add(path.resolve())
