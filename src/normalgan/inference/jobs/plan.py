"""Plan: decide which files are read for each drawing and which are written."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from normalgan.errors import InputError, writing
from normalgan.files.writing import probe
from normalgan.inference.jobs.folders import find_drawings, search
from normalgan.inference.mask.mask_files import ENDINGS as MASK_ENDINGS
from normalgan.inference.mask.mask_files import SOURCES, MaskSource
from normalgan.inference.outputs import OUTPUTS
from normalgan.inference.reading.drawings import SUFFIXES, find_companion
from normalgan.inference.reading.hint_files import ENDINGS as HINT_ENDINGS

STDIN = STDOUT = "-"
FILES: dict[str, Literal["png", "exr", "tiff"]] = {
    **{".png": "png", ".apng": "png", ".gif": "png", ".webp": "png"},
    **{".exr": "exr", ".tif": "tiff", ".tiff": "tiff"},
}
"""Endings of map files and their formats; GIF and WebP hold animations."""
_NO_MAPS = {
    *(each for each in SUFFIXES if each not in FILES),
    *(".avif", ".dds", ".hdr", ".jxl", ".ktx", ".ktx2", ".tga", ".avi", ".mov", ".mp4", ".webm", ".json"),
}
"""Endings of unsupported map files; an output path with such an ending is not treated as a folder."""


@dataclass(frozen=True)
class DrawingFiles:
    """The input files of a drawing.

    Args:
        drawing: file of the drawing, or a name for standard input.
        content: content of standard input; None for a file.
        hints: file of the hints, or None.
        mask: file of the mask, a mask source, or None.
        below: subfolder of the output folder that the map goes to.
    """

    drawing: Path
    content: bytes | None = None
    hints: Path | None = None
    mask: Path | MaskSource | None = None
    below: Path = Path()

    @property
    def companions(self) -> list[Path]:
        """The files that are read in addition to the drawing."""
        return [each for each in (self.hints, self.mask) if isinstance(each, Path)]


@dataclass(frozen=True)
class Job:
    """One drawing to predict.

    Args:
        files: input files.
        target: path of the normal map.
        stem: stem of the file names of all other outputs.
        exact: whether the user named the map's file, which fixes its format.
    """

    files: DrawingFiles
    target: Path
    stem: str
    exact: bool = False

    def path_with(self, ending: str) -> Path:
        """Return the path of another output of the drawing; ``ending`` is, for example, ``_input.png``."""
        return self.target.with_name(self.stem + ending)

    def numbered(self, number: int, ending: str) -> "Job":
        """Return the job of one frame, numbered from 1; ``ending`` is the ending of a map's name."""
        stem = f"{self.stem}_{number:04d}"
        return Job(self.files, self.target.with_name(stem + ending), stem)


def find_files(
    sketches: str | Sequence[str], hints: str | None = None, mask: str | None = None
) -> list[DrawingFiles]:
    """Return the named drawings with their hints and masks; normal maps next to them are skipped.

    Args:
        sketches: files, folders and globs.
        hints: a file or a folder.
        mask: a file, a folder or a mask source.

    Raises:
        InputError: if a file or folder is missing.
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
    """Return the named drawings, and an error for each name that matches no drawing.

    Args:
        sketches: files, folders and globs; ``-`` stands for ``content``.
        ending: ending of a normal map's name; files with this ending are not drawings.
        hints: as in `find_files`.
        mask: as in `find_files`.
        content: content of standard input.
        recursive: whether subfolders are searched too.
        folder: output folder, which is not searched.
        may_be_empty: whether a folder may have no drawings.

    Raises:
        InputError: if a file or folder of hints or masks is missing.
    """
    named = [each for each in sketches if each != STDIN]
    found, wrong = search(named, companions_of(ending), recursive, folder, may_be_empty)
    read = [DrawingFiles(drawing, below=below) for drawing, below in found.items()]
    if STDIN in sketches:
        read.append(DrawingFiles(Path("stdin"), content))
    return (_with_companions(read, hints, mask) if read else []), wrong


def companions_of(ending: str) -> tuple[str, ...]:
    """Return the name suffixes of files that accompany a drawing, such as ``_hints``.

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
    """Return a job for each drawing.

    Args:
        files: the drawings.
        folder: output folder.
        ending: ending of a normal map's name, such as ``_normal.png``.
        others: endings of the other outputs.
        may_clash: whether two drawings may have the same output file, because the caller handles it.
        also_read: other input files, such as the model.

    Raises:
        InputError: if an input would be overwritten, or two outputs would have the same name.
    """
    jobs = [
        Job(each, folder / each.below / f"{each.drawing.stem}{ending}", each.drawing.stem) for each in files
    ]
    _check_names(jobs, others, also_read, may_clash)
    return jobs


def is_file_name(output: Path) -> bool:
    """Return whether an output path is a map's file name, not a folder.

    Raises:
        InputError: if it has the ending of an unsupported file format.
    """
    if output.is_dir():
        return False
    if output.suffix.lower() in _NO_MAPS:
        raise InputError(
            f"{output} is not a supported file name for a map; use .png, .exr, .tif or .tiff, for an "
            "animation .gif, .webp or .apng, or name a folder (-o)."
        )
    return output.suffix.lower() in FILES


def format_of(target: Path, asked: str | None) -> Literal["png", "exr", "tiff"]:
    """Return the format of a map from its file name.

    Args:
        target: path of the map.
        asked: the requested format, or None.

    Raises:
        InputError: if the file name and the requested format disagree.
    """
    found = FILES[target.suffix.lower()]
    if asked not in {None, found}:
        raise InputError(f"{target} is not {asked}; name a file of that kind, or omit --format.")
    return found


def plan_file(
    files: Sequence[DrawingFiles], target: Path, others: Sequence[str] = (), also_read: Sequence[Path] = ()
) -> Job:
    """Return the job of a single drawing whose map goes to a named file; see `plan`.

    Raises:
        InputError: if there are several drawings, or an input would be overwritten.
    """
    if len(files) != 1:
        raise InputError(f"{target} is one file, but there are {len(files)} sketches; name a folder (-o).")
    job = Job(files[0], target, target.stem, exact=True)
    _check_names([job], others, also_read)
    return job


def check_writable(jobs: Sequence[Job]) -> None:
    """Raise `InputError` if a map's path cannot be written."""
    for target in (job.target for job in jobs if job.target.is_dir()):
        raise InputError(f"the normal map cannot be written to {target}: it is a folder.")
    for folder in {job.target.parent for job in jobs}:
        there = next(each for each in (folder, *folder.absolute().parents) if each.exists())
        with writing("the normal map", folder):
            probe(there)


def overwritten(path: Path) -> InputError:
    """Return the error for an output that is also an input."""
    return InputError(f"{path} is an input and would be overwritten; give another folder (-o) or --suffix.")


def _companions(
    read: Sequence[DrawingFiles], named: str | None, kind: str, endings: Sequence[str]
) -> list[Path | None]:
    """Return the hints or mask file of each drawing, or None."""
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
    given = [(job.files.drawing, *job.files.companions) for job in jobs]
    read = {path.resolve() for each in (*given, also_read) for path in each}
    written: set[Path] = set()
    for job in jobs:
        if may_clash:
            written.clear()
        for path in (job.target, *(job.path_with(ending) for ending in others)):
            if path.resolve() in read:
                raise overwritten(path)
            if path.resolve() in written:
                raise InputError(f"{path} would be written twice; rename a sketch, or give another --suffix.")
            written.add(path.resolve())
