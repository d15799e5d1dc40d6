"""Folders: find drawings by name, folder or glob, and decide which subfolders their maps go to."""

import os
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path

from normalgan.errors import InputError
from normalgan.files.globs import matches
from normalgan.inference.reading.drawings import SUFFIXES, is_drawing, without_companions


def find_drawings(
    source: str | Sequence[str], ending: str = "_normal.png", companions: Sequence[str] = ()
) -> list[Path]:
    """Return the named drawings in order.

    Args:
        source: a folder, glob or file, or a list of them.
        ending: ending that follows a drawing's stem in the names of outputs.
        companions: as in `search`.

    Raises:
        InputError: if a name matches no drawing, or two drawings have the same stem.
    """
    found, errors = search([source] if isinstance(source, str) else source, companions)
    if errors:
        raise errors[0]
    by_name: dict[str, Path] = {}
    for path in found:
        other = by_name.setdefault(path.stem, path)
        if other is not path:
            raise InputError(f"{other} and {path} would both be written as {path.stem}{ending}; rename one.")
    return list(found)


def search(
    words: Sequence[str],
    companions: Sequence[str] = (),
    recursive: bool = False,
    leave_out: Path | None = None,
    may_be_empty: bool = False,
) -> tuple[dict[Path, Path], list[InputError]]:
    """Return the named drawings in order, and an error for each name that matches no drawing.

    Each drawing is mapped to the subfolder of the output folder that its map goes to. With ``recursive``,
    this is its path below the named folder, otherwise it is empty. Drawings with the same name from different
    folders get different subfolders.

    Args:
        words: files, folders and globs.
        companions: endings of files that accompany a drawing; a file named after a drawing's stem plus one of
            them is not a drawing.
        recursive: whether subfolders are searched too. Hidden files are ignored in every folder.
        leave_out: folder that is not searched, usually the output folder.
        may_be_empty: whether folders without drawings are accepted, because drawings may arrive later.
    """
    found: dict[Path, Path] = {}
    errors = []
    for word in words:
        if not word:  # a shell's empty variable, and no wish for every drawing of the current folder
            errors.append(InputError("a sketch has an empty name; name a file or a folder, such as '.'."))
            continue
        place = Path(word)
        broken: list[Path] = []
        if place.is_file():
            here = {place: Path()}
        elif place.is_dir():
            files = list(_below(place, leave_out) if recursive else place.iterdir())
            drawings = [path for path in files if is_drawing(path) and path.is_file()]
            broken = sorted(path for path in files if is_drawing(path) and _is_broken(path))
            kept = without_companions(sorted(drawings), companions)
            here = {path: path.parent.relative_to(place) for path in kept}
        else:
            every = matches(word)
            broken = [path for path in {place: place, **dict.fromkeys(every)} if _is_broken(path)]
            files = [path for path in every if path.is_file() and not path.name.startswith("._")]
            here = dict.fromkeys(without_companions(files, companions), Path())
        errors += [
            InputError(f"{path} is a link to {path.readlink()}, which does not exist.") for path in broken
        ]
        if not here and not broken and not (may_be_empty and place.is_dir()):
            errors.append(_nothing_found(word, leave_out))
        found |= {path: below for path, below in here.items() if path not in found}
    return _apart(found), errors


def _nothing_found(word: str, leave_out: Path | None) -> InputError:
    """Return the error for a name that matches no drawing."""
    below = _below(Path(word), leave_out) if Path(word).is_dir() else ()
    deep = next((path for path in below if is_drawing(path) and path.is_file()), None)
    if deep is not None:
        return InputError(
            f"no sketch found at {word!r}, only in subfolders such as {deep.parent}; name them, or let "
            "generate search them with --recursive."
        )
    return InputError(
        f"no sketch found at {word!r}; give a folder, a file or a glob of {' '.join(SUFFIXES)}."
    )


def _is_broken(path: Path) -> bool:
    return path.is_symlink() and not path.exists()


def _below(folder: Path, leave_out: Path | None) -> Iterator[Path]:
    """Yield the files below a folder, except in hidden folders and in ``leave_out``."""
    left_out = None if leave_out is None else leave_out.resolve()
    for path, folders, names in os.walk(folder):
        here = Path(path)
        if left_out is not None and left_out != folder.resolve():
            folders[:] = [each for each in folders if (here / each).resolve() != left_out]
        folders[:] = sorted(each for each in folders if not each.startswith("."))
        yield from (here / name for name in names)


def _apart(found: dict[Path, Path]) -> dict[Path, Path]:
    """Return the drawings with those of the same name from different folders in separate subfolders."""
    named = defaultdict(list)
    for path, below in found.items():
        named[below / path.stem].append(path)
    for paths in named.values():
        folders = {path.parent.resolve() for path in paths}
        if len(folders) > 1:
            top = os.path.commonpath(folders)
            for path in paths:
                found[path] = found[path] / path.parent.resolve().relative_to(top)
    return found
