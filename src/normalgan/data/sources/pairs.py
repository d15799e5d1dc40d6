"""Pairs: sketches and their normal maps as files: in a folder, by a pattern, or listed in a CSV."""

import csv
import hashlib
import io
import json
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from glob import glob
from os.path import commonpath
from pathlib import Path, PurePath
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from normalgan.arrays import BoolMask
from normalgan.data.sources.base import DATA_SOURCES, PairSource, SplitSettings
from normalgan.data.sources.pair import PAIRS_VERSION, Pair, background
from normalgan.data.splits import SPLITS
from normalgan.errors import InputError, did_you_mean, with_subject
from normalgan.files.limits import read_bounded
from normalgan.inference.inputs import AnyPicture, as_picture
from normalgan.inference.reading.drawings import is_drawing, read_normals, read_pixels
from normalgan.inference.reading.hint_files import load_hints
from normalgan.normals import Green, flip_green

__all__ = ["COLUMNS", "NORMAL_SUFFIXES", "PairFiles", "Pairs"]

NORMAL_SUFFIXES = (".png", ".exr", ".tif", ".tiff", ".webp", ".jpg", ".jpeg", ".bmp")
"""What a normal map's file may end in, in the order in which it is looked for."""
COLUMNS = ("sketch", "normal", "mask", "hints", "group", "split", "name")
"""The columns of a CSV; the first two it must have."""

_FOLDERS = {
    "sketch": ("sketch", "sketches"),
    "normal": ("normal", "normals"),
    "mask": ("mask", "masks"),
    "hints": ("hints", "hint"),
}
_ENDS_IN = {"normal": NORMAL_SUFFIXES, "mask": (".png", ".webp", ".bmp"), "hints": (".png", ".json")}
_ZERO = 0.05
"""A vector shorter than this is none, in 8 bits too, and says that there is no object."""
_SHOWN = 20
"""As many of what was left out are listed in a warning."""
_HEADERS = ("PNG", "JPEG", "BMP", "TIFF", "GIF")
"""Formats whose headers Pillow reads in Python alone; others are opened by the decoding process alone."""
_WITH_HEADER = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".gif"}
_PARTNERS = tuple(f"_{kind}" for kind in _ENDS_IN)
_RIGHT = (
    "a pair is a.png with a_normal.png beside it, or sketch/a.png with normal/a.png in the folder next to "
    "it, or A/a.png with B/a.png, or one picture of both, side by side, in AB; the last two also in train, "
    "val and test below these"
)


@dataclass(frozen=True)
class PairFiles:
    """A pair on disk.

    Args:
        name: what it is called.
        sketch: its sketch, of any format that is read.
        normal: its normal map.
        mask: where the object is; None is what the normal map's opacity or its background tells.
        hints: normals that a designer gave, PNG or JSON; None for none.
        green: which way of y the normal map, and hints that are painted, hold.
        group: what it must not be separated from.
        part: the split it is in, None if that is not said.
    """

    name: str
    sketch: Path
    normal: Path
    mask: Path | None = None
    hints: Path | None = None
    green: Green = "up"
    group: str = ""
    part: str | None = None

    def fingerprint(self) -> str:
        """Return a hash of the files' bytes and the settings.

        Raises:
            InputError: if a file cannot be read.
        """
        digest = hashlib.sha256(json.dumps([PAIRS_VERSION, self.name, self.green]).encode())
        for path in (self.sketch, self.normal, self.mask, self.hints):
            digest.update(b"none" if path is None else hashlib.sha256(_bytes(path)).digest())
        return digest.hexdigest()

    def load(self) -> Pair:
        """Return the pair.

        Raises:
            InputError: if a file cannot be used, or they do not go together.
        """
        picture: AnyPicture = self.sketch
        vectors, alpha = read_normals(self.normal, self.green)
        if self.sketch == self.normal:  # side by side: the sketch on the left
            middle = vectors.shape[1] // 2
            picture = read_pixels(self.sketch).pixels[:, :middle]
            vectors, alpha = vectors[:, middle:], None if alpha is None else alpha[:, middle:]
        sketch = as_picture(picture)
        hints = None if self.hints is None else load_hints(self.hints, sketch.shape)
        if hints is not None and self.hints is not None and self.hints.suffix.lower() == ".png":
            hints = replace(hints, normals=flip_green(hints.normals)) if self.green == "down" else hints
        try:
            return Pair(sketch, vectors, self.mask or _object(vectors, alpha), hints)
        except InputError as error:
            raise with_subject(self.normal, error) from error


@DATA_SOURCES.register
@dataclass(frozen=True)
class Pairs(PairSource):
    """Sketches and their normal maps on disk, pixel on pixel; no meshes.

    Args:
        files: a folder, a glob of sketches, a CSV, or a list of these; folders of pix2pix are read as
            they are (``A`` and ``B``, or ``AB/train`` with both side by side). The normal map of ``a.png`` is
            ``a_normal.png`` beside it, or in a folder ``normal`` next to its folder ``sketch``; so for masks
            and hints.
        green: which way of y the normal maps hold as green: up as in OpenGL, down as in DirectX.
        hints: take the hints that pairs have, in place of a sampler's; a pair without gets none.
        group_by: what is on one side of the split: each file by itself, or all of a folder; the group of a
            CSV counts before it.

    Raises:
        InputError: if a setting is none of these.
    """

    files: str | list[str]  # or paths of pathlib, from Python
    green: Green = "up"
    hints: bool = False
    group_by: Literal["file", "folder"] = "file"

    def __post_init__(self) -> None:
        if self.green not in get_args(Green):
            raise InputError(f"Pairs was given green={self.green!r}; it is up (OpenGL) or down (DirectX).")
        if self.group_by not in {"file", "folder"}:
            raise InputError(f"Pairs was given group_by={self.group_by!r}; give file or folder.")
        object.__setattr__(self, "files", _as_texts(self.files))

    def split(self, settings: SplitSettings) -> Mapping[str, Sequence[PairFiles]]:
        """Return the pairs of each split: as a CSV says, or dealt out by file or by group.

        Raises:
            InputError: if a list cannot be used, the split cannot, or no pair of a split can.
        """
        left_out: list[str] = []
        pairs = self._find(left_out)
        parts = self._parts(pairs, settings)
        # After the split: a file that is damaged moves no other pair to another side.
        flaws = _flaws([pair for pair in pairs if pair.name in parts])
        split: dict[str, list[PairFiles]] = {part: [] for part in SPLITS}
        for pair in pairs:
            if pair.name in parts and pair.name not in flaws:
                split[parts[pair.name]].append(pair)
        for part, usable in split.items():
            named = [name for name, of in parts.items() if of == part]
            if named and not usable:
                raise InputError(
                    f"none of the {len(named)} pairs for {part} can be used; the first: {flaws[named[0]]}."
                )
        _warn(left_out + list(flaws.values()))
        return split

    def _parts(self, pairs: Sequence[PairFiles], settings: SplitSettings) -> dict[str, str]:
        """Return the split of each pair by name; a pair that a split file does not name has none."""
        if pairs[0].part is not None:
            return {pair.name: pair.part for pair in pairs if pair.part is not None}
        grouped = any(pair.group != pair.name for pair in pairs)
        groups = list(dict.fromkeys(pair.group for pair in pairs))
        part_of = {
            group: part
            for part, with_subject in settings.deal(groups, "group" if grouped else "pair").items()
            for group in with_subject
        }
        return {pair.name: part_of[pair.group] for pair in pairs if pair.group in part_of}

    def found(self) -> list[PairFiles]:
        """Return all pairs, in order of their names; a warning lists what has no partner.

        Raises:
            InputError: if there are none, or two have one name.
        """
        left_out: list[str] = []
        pairs = self._find(left_out)
        _warn(left_out)
        return pairs

    def _find(self, left_out: list[str]) -> list[PairFiles]:
        """Return all pairs in order of their names; note what has no partner. Raises as `found` does."""
        entries = [self.files] if isinstance(self.files, str) else self.files
        pairs = [self._with_settings(pair) for entry in entries for pair in _found_at(entry, left_out)]
        if left_out and not pairs:
            raise InputError(f"{left_out[0]}; {_RIGHT}.")
        if not pairs:
            raise InputError("Pairs was given no files; name a folder, a glob of sketches, or a CSV.")
        twice = [name for name, count in Counter(pair.name for pair in pairs).items() if count > 1]
        if twice:
            of_name = [str(pair.sketch) for pair in pairs if pair.name == twice[0]]
            raise InputError(f"two pairs are named {twice[0]}: {of_name[0]} and {of_name[1]}; rename one.")
        parts = {pair.part is None for pair in pairs}
        if len(parts) > 1:
            lacking = next(pair for pair in pairs if pair.part is None)
            raise InputError(
                f"{lacking.sketch} is in no split, but others are; give all of them one, or none."
            )
        sides: dict[str, str | None] = {}
        for pair in pairs:
            if sides.setdefault(pair.group, pair.part) != pair.part:
                raise InputError(
                    f"the group {pair.group} is in {sides[pair.group]} and in {pair.part}; a group belongs "
                    "to one split."
                )
        return sorted(pairs, key=lambda pair: pair.name)

    def _with_settings(self, pair: PairFiles) -> PairFiles:
        folder = pair.name.rpartition("/")[0] or "."
        group = pair.group or (folder if self.group_by == "folder" else pair.name)
        return replace(pair, green=self.green, group=group, hints=pair.hints if self.hints else None)


def _warn(left_out: Sequence[str]) -> None:
    """Warn of all that is left out, in one list."""
    if left_out:
        more = [f"and {len(left_out) - _SHOWN} more"] if len(left_out) > _SHOWN else []
        listed = "; ".join([*left_out[:_SHOWN], *more])
        files = "1 file is" if len(left_out) == 1 else f"{len(left_out)} files are"
        warnings.warn(f"{files} left out: {listed}.", stacklevel=3)


def _flaws(pairs: Sequence[PairFiles]) -> dict[str, str]:
    """Return why pairs cannot be used whose headers look wrong, by name.

    Ten thousand headers are read in a second. Only a pair whose headers look wrong is decoded, which tells
    the reason; what only pixels tell is found when a pair is first asked for.
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
    """Return whether the sketch, the normal map and the mask seem to be pictures of one size."""
    paths = [path for path in (pair.sketch, pair.normal, pair.mask) if path is not None]
    sizes = {_size(path) for path in paths if path.suffix.lower() in _WITH_HEADER}
    return len(sizes) <= 1 and None not in sizes


def _size(path: Path) -> tuple[int, ...] | None:
    """Return the shorter and the longer side that a picture's header tells; None if it cannot be read."""
    try:
        with warnings.catch_warnings(action="ignore"), Image.open(path, formats=_HEADERS) as picture:
            return tuple(sorted(picture.size))  # it may be turned when it is read
    except Exception:  # whatever a damaged file brings about
        return None


def _as_texts(files: object) -> str | list[str]:
    """Return paths, of which Python may give those of pathlib, as a configuration names them."""
    if isinstance(files, str | PurePath):
        return str(files)
    if isinstance(files, list | tuple) and all(isinstance(each, str | PurePath) for each in files):
        return [str(each) for each in files]
    raise InputError(
        f"Pairs was given files={files!r}; name a folder, a glob of sketches, a CSV, or a list of these."
    )


def _found_at(entry: str, left_out: list[str]) -> Iterator[PairFiles]:
    """Yield the pairs at a folder, a file or a glob; note what has no partner."""
    path = Path(entry)
    if path.is_dir() and (known := list(_pix2pix(path, left_out))):
        yield from known
        return
    if path.suffix.lower() == ".csv":
        yield from _listed(path, left_out)
        return
    if path.is_dir():
        inner = _subfolder(path, "sketch")
        within = [each for each in (inner or path).iterdir() if is_drawing(each)]
        sketches = sorted(each for each in within if inner or not _is_partner(each))
        for orphan in _orphans(path, inner, sketches):
            left_out.append(f"{orphan} has no sketch")
        root = path
    elif path.is_file():
        sketches, root = [path], path.parent
    else:
        found = [Path(each) for each in glob(entry, recursive=True)]
        sketches = sorted(
            each for each in found if each.is_file() and is_drawing(each) and not _is_partner(each)
        )
        root = Path(commonpath([each.parent for each in sketches])) if sketches else Path()
    if not sketches:
        kind = "an empty folder" if path.is_dir() and not any(path.iterdir()) else "no sketch"
        below = path.is_dir() and any(is_drawing(each) for each in path.glob("*/*"))
        more = f"; those in folders below it are named by a glob, '{entry}/**/*.png'" if below else ""
        raise InputError(f"{kind} is at {entry}; {_RIGHT}{more}.")
    for sketch in sketches:
        normal = _partner(sketch, "normal")
        if normal is None:
            left_out.append(f"{sketch} has no normal map")
            continue
        name = _name(sketch, root)
        yield PairFiles(name, sketch, normal, _partner(sketch, "mask"), _partner(sketch, "hints"))


def _pix2pix(root: Path, left_out: list[str]) -> Iterator[PairFiles]:
    """Yield the pairs of a folder laid out as for pix2pix: ``A`` and ``B``, or both side by side in ``AB``.

    ``A`` holds the sketches and ``B`` the normal maps; side by side the sketch is on the left. ``train``,
    ``val`` and ``test`` below them are the splits.
    """
    a, b, both = (root / name for name in ("A", "B", "AB"))
    for part in (None, *SPLITS):
        below = part or "."
        if (a / below).is_dir() and (b / below).is_dir():
            normals = {path.stem: path for path in _pictures(b / below)}
            for sketch in sorted(filter(is_drawing, (a / below).iterdir())):
                if (normal := normals.pop(sketch.stem, None)) is None:
                    left_out.append(f"{sketch} has no normal map")
                else:
                    yield PairFiles(_in_part(part, sketch), sketch, normal, part=part)
            left_out += [f"{normal} has no sketch" for normal in normals.values()]
        elif not a.is_dir() and ((both / below).is_dir() or (part and not both.is_dir())):
            folder = both / below if both.is_dir() else root / below
            pictures = _pictures(folder) if folder.is_dir() else []
            if pictures and _is_double(pictures[0]):
                for picture in pictures:
                    yield PairFiles(_in_part(part, picture), picture, picture, part=part)


def _pictures(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.suffix.lower() in NORMAL_SUFFIXES)


def _in_part(part: str | None, path: Path) -> str:
    return f"{part}/{path.stem}" if part else path.stem


def _is_double(path: Path) -> bool:
    """Return whether a picture is twice as wide as high, as one of sketch and normal map is."""
    height, width = read_pixels(path).pixels.shape[:2]
    return bool(width == 2 * height)


def _name(sketch: Path, root: Path) -> str:
    """Return what a pair is called: the path of its sketch, without what tells that it is one."""
    try:
        folders = sketch.parent.relative_to(root).parts
    except ValueError:
        folders = ()
    kept = [folder for folder in folders if folder.lower() not in _FOLDERS["sketch"]]
    return "/".join([*kept, sketch.stem.removesuffix("_sketch")])


def _partner(sketch: Path, kind: str) -> Path | None:
    """Return the file of a kind that belongs to a sketch, None if there is none."""
    stem = sketch.stem.removesuffix("_sketch")
    beside = [sketch.with_name(f"{stem}_{kind}{ending}") for ending in _ENDS_IN[kind]]
    if sketch.parent.name.lower() in _FOLDERS["sketch"]:
        folder = _subfolder(sketch.parent.parent, kind)
        if folder is not None:
            stems = [sketch.stem, stem, f"{stem}_{kind}"]
            beside += [folder / f"{name}{ending}" for name in stems for ending in _ENDS_IN[kind]]
    return next((path for path in beside if path.is_file()), None)


def _orphans(folder: Path, inner: Path | None, sketches: Sequence[Path]) -> Iterator[Path]:
    """Yield the normal maps of a folder that no sketch belongs to."""
    partners = {_partner(sketch, "normal") for sketch in sketches}
    where = _subfolder(folder, "normal") if inner else folder
    for path in sorted(where.iterdir()) if where else []:
        is_normal = path.suffix.lower() in NORMAL_SUFFIXES and (inner or path.stem.endswith("_normal"))
        if is_normal and not path.name.startswith(".") and path not in partners:
            yield path


def _subfolder(folder: Path, kind: str) -> Path | None:
    return next((folder / name for name in _FOLDERS[kind] if (folder / name).is_dir()), None)


def _is_partner(path: Path) -> bool:
    others = {name for kind in _ENDS_IN for name in _FOLDERS[kind]}
    return path.stem.endswith(_PARTNERS) or path.parent.name.lower() in others


def _listed(path: Path, left_out: list[str]) -> Iterator[PairFiles]:
    """Yield the pairs in a CSV, whose paths start from its folder; note those that lack a file."""
    right = f"its first line names columns, {', '.join(COLUMNS[:2])} and perhaps {', '.join(COLUMNS[2:])}"
    try:
        text = _bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path} is not a text in UTF-8; {right}.") from None
    reader = csv.DictReader(io.StringIO(text), skipinitialspace=True)
    try:
        columns = list(reader.fieldnames or [])
        rows = [(reader.line_num, row) for row in reader]
    except csv.Error as error:
        raise InputError(f"{path} is no CSV ({error}); {right}.") from None
    if unknown := [column for column in columns if column not in COLUMNS]:
        raise InputError(
            f"{path} has a column {unknown[0]!r}, which means nothing here."
            f"{did_you_mean(unknown[0], COLUMNS)} {right[0].upper()}{right[1:]}."
        )
    if missing := [column for column in COLUMNS[:2] if column not in columns]:
        raise InputError(f"{path} has no column {missing[0]!r}; {right}.")
    if not rows:
        raise InputError(f"{path} lists no pair; each line after the first is one.")
    for line, row in rows:
        where = f"line {line} of {path}"
        if None in row or None in row.values():
            raise InputError(f"{where} does not have as many values as there are columns, {len(columns)}.")
        files = {kind: path.parent / row[kind] if row.get(kind) else None for kind in _FOLDERS}
        part = row.get("split") or None
        if part is not None and part not in SPLITS:
            raise InputError(f"{where} has the split {part!r}; it is {', '.join(SPLITS)}, or empty.")
        sketch, normal = files["sketch"], files["normal"]
        if sketch is None or normal is None:
            raise InputError(f"{where} names no {'sketch' if sketch is None else 'normal'}; a pair has both.")
        missing = [kind for kind, file in files.items() if file is not None and not file.is_file()]
        if missing:
            kind = missing[0]
            left_out.append(f"{where} names {row[kind]} as {kind}, and there is no file {files[kind]}")
            continue
        name = row.get("name") or _name(Path(row["sketch"]), Path())
        yield PairFiles(
            name, sketch, normal, files["mask"], files["hints"], group=row.get("group", ""), part=part
        )


def _object(vectors: NDArray[np.floating], alpha: NDArray[np.floating] | None) -> BoolMask:
    """Return the object of a normal map without a mask: what is opaque, or what is not its background."""
    found = alpha > 0.5 if alpha is not None and float(alpha.min()) <= 0.5 else ~background(vectors)
    found = np.asarray(found & (np.linalg.norm(vectors, axis=-1) > _ZERO))
    if not found.any():
        raise InputError("the normal map shows nothing but its background.")
    return found


def _bytes(path: Path) -> bytes:
    try:
        return read_bounded(path)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from None
