"""Pairs: a data source of sketches and their normal maps on disk."""

import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePath
from typing import Literal

from normalgan.data.sources.base import DATA_SOURCES, PairSource, SplitSettings
from normalgan.data.sources.pair_files import LAYOUTS, TABLES, Direction, PairFiles, find_pairs, header_size
from normalgan.data.splits import SPLITS, none_usable
from normalgan.errors import InputError
from normalgan.normals import Green

_SHOWN = 20
"""Maximum number of files that a warning lists."""
_WITH_HEADER = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".gif"}


@DATA_SOURCES.register
@dataclass(frozen=True)
class Pairs(PairSource):
    """Aligned sketches and normal maps on disk, without meshes.

    Args:
        files: folder, glob of sketches, CSV, or a list of these. pix2pix folders are supported (``A`` and
            ``B``, or side-by-side pictures in ``AB/train``), and so are folders of splits. The normal map of
            ``a.png`` is ``a_normal.png`` in the same folder, or is in a folder ``normal`` next to its folder
            ``sketch``. The same holds for masks and hints.
        green: direction of the normal maps' green channel: up as in OpenGL, down as in DirectX.
        hints: whether to use the pairs' own hints instead of a sampler's; pairs without hints get none.
        group_by: unit that is never divided by the split: file or folder. A group given in a CSV takes
            precedence.
        direction: position of the sketch in pix2pix folders: ``A`` or the left half (AtoB), or ``B`` or
            the right half (BtoA).
        resplit: whether to split all pairs by ``data.split`` even if their folders or their CSV give
            splits.

    Raises:
        InputError: if a setting is invalid.
    """

    files: str | list[str]  # or pathlib paths, from Python
    green: Green = "up"
    hints: bool = False
    group_by: Literal["file", "folder"] = "file"
    direction: Direction = "AtoB"
    resplit: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "files", _as_texts(self.files))

    def split(self, settings: SplitSettings) -> Mapping[str, Sequence[PairFiles]]:
        """Return the pairs of each split, as given by a CSV or folders, or split by file or by group.

        Raises:
            InputError: if a list or the split is invalid, or a split has no usable pair.
        """
        pairs, left_out = self._find()
        parts = self._parts(pairs, settings)
        # After the split, so that a damaged file does not move other pairs to another split.
        flaws = _flaws([pair for pair in pairs if pair.name in parts])
        split: dict[str, list[PairFiles]] = {part: [] for part in SPLITS}
        for pair in pairs:
            if pair.name in parts and pair.name not in flaws:
                split[parts[pair.name]].append(pair)
        for part, usable in split.items():
            named = [name for name, of in parts.items() if of == part]
            if named and not usable:
                raise none_usable(len(named), "pair", part, f"{flaws[named[0]]}.")
        _warn(left_out + list(flaws.values()))
        return split

    def _parts(self, pairs: Sequence[PairFiles], settings: SplitSettings) -> dict[str, str]:
        """Return the split of each pair by name; pairs missing from a split file are left out."""
        if pairs[0].part is not None:
            if settings.file is not None:
                raise InputError(
                    f"data.split.file is {settings.file}, but the folders or the CSV of the pairs give their "
                    "splits; pass --data.source.resplit true to split by the file."
                )
            return {pair.name: pair.part for pair in pairs if pair.part is not None}
        grouped = any(pair.group != pair.name for pair in pairs)
        groups = list(dict.fromkeys(pair.group for pair in pairs))
        part_of = {
            group: part
            for part, of_part in settings.deal(groups, "group" if grouped else "pair").items()
            for group in of_part
        }
        return {pair.name: part_of[pair.group] for pair in pairs if pair.group in part_of}

    def found(self) -> list[PairFiles]:
        """Return all pairs sorted by name, with a warning that lists files without a partner.

        Raises:
            InputError: if there are no pairs, or two have the same name.
        """
        pairs, left_out = self._find()
        _warn(left_out)
        return pairs

    def _find(self) -> tuple[list[PairFiles], list[str]]:
        """Return all pairs sorted by name, and why other files are left out. Raises as `found`."""
        entries = [self.files] if isinstance(self.files, str) else self.files
        found = [each for entry in entries for each in find_pairs(entry, self.direction)]
        pairs = [self._with_settings(each) for each in found if isinstance(each, PairFiles)]
        left_out = [each for each in found if isinstance(each, str)]
        if left_out and not pairs:
            listed = all(Path(entry).suffix.lower() in TABLES for entry in entries)
            raise InputError(f"{left_out[0]}{'' if listed else f'; {LAYOUTS}'}.")
        if not pairs:
            raise InputError("Pairs was given no files; name a folder, a glob of sketches, or a CSV.")
        if self.hints and not any(pair.hints for pair in pairs):
            raise InputError(
                "hints of Pairs is true, but no pair has hints, which are a_hints.png or a_hints.json beside "
                "a.png, files in a folder hints next to sketch, or a column of a CSV; add them, or set it to "
                "false, to train with those of a sampler."
            )
        twice = [name for name, count in Counter(pair.name for pair in pairs).items() if count > 1]
        if twice:
            of_name = [str(pair.sketch) for pair in pairs if pair.name == twice[0]]
            raise InputError(f"two pairs are named {twice[0]}: {of_name[0]} and {of_name[1]}; rename one.")
        parts = {pair.part is None for pair in pairs}
        if len(parts) > 1:
            lacking = next(pair for pair in pairs if pair.part is None)
            raise InputError(f"{lacking.sketch} has no split, but others do; give every pair one, or none.")
        sides: dict[str, str | None] = {}
        for pair in pairs:
            if sides.setdefault(pair.group, pair.part) != pair.part:
                raise InputError(
                    f"the group {pair.group} is in {sides[pair.group]} and in {pair.part}; a group belongs "
                    "to one split."
                )
        return sorted(pairs, key=lambda pair: pair.name), left_out

    def _with_settings(self, pair: PairFiles) -> PairFiles:
        folder = pair.name.rpartition("/")[0] or "."
        group = pair.group or (folder if self.group_by == "folder" else pair.name)
        hints = pair.hints if self.hints else None
        part = None if self.resplit else pair.part
        return replace(pair, green=self.green, group=group, hints=hints, part=part)


def _warn(left_out: Sequence[str]) -> None:
    """Warn about all files that are left out, in one list."""
    if left_out:
        more = [f"and {len(left_out) - _SHOWN} more"] if len(left_out) > _SHOWN else []
        listed = "; ".join([*left_out[:_SHOWN], *more])
        files = "1 file is" if len(left_out) == 1 else f"{len(left_out)} files are"
        warnings.warn(f"{files} left out: {listed}.", stacklevel=3)


def _flaws(pairs: Sequence[PairFiles]) -> dict[str, str]:
    """Return the reasons why pairs with suspicious headers cannot be used, by name.

    Ten thousand headers are read in a second. Only pairs with suspicious headers are decoded, to find the
    reason. Faults in pixels are found when a pair is first read.
    """
    found = {}
    for pair in pairs:
        if not _headers_agree(pair):
            try:
                pair.load()
            except InputError as error:
                found[pair.name] = str(error).removesuffix(".")
    return found


def _headers_agree(pair: PairFiles) -> bool:
    """Return whether the headers of sketch, normal map and mask give the same size."""
    paths = [path for path in (pair.sketch, pair.normal, pair.mask) if path is not None]
    sizes = {_size(path) for path in paths if path.suffix.lower() in _WITH_HEADER}
    return len(sizes) <= 1 and None not in sizes


def _size(path: Path) -> tuple[int, ...] | None:
    """Return the shorter and the longer side from a picture's header, or None if it cannot be read."""
    size = header_size(path)
    return None if size is None else tuple(sorted(size))  # a picture may be rotated on reading


def _as_texts(files: object) -> str | list[str]:
    """Return paths as strings, as in a configuration; callers from Python may pass `pathlib.Path`."""
    if isinstance(files, str | PurePath):
        return str(files)
    if isinstance(files, list | tuple) and all(isinstance(each, str | PurePath) for each in files):
        return [str(each) for each in files]
    raise InputError(
        f"Pairs was given files={files!r}; name a folder, a glob of sketches, a CSV, or a list of these."
    )
