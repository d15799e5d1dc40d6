"""Files of pairs: finding them in a folder, by a pattern or in a CSV, and reading them."""

import csv
import hashlib
import io
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from glob import glob
from os.path import commonpath
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask
from normalgan.data.sources.pair import PAIRS_VERSION, Pair, background
from normalgan.data.splits import SPLITS
from normalgan.errors import InputError, did_you_mean, with_subject
from normalgan.files.limits import read_named
from normalgan.inference.inputs import AnyPicture, as_picture
from normalgan.inference.reading.drawings import is_drawing, read_normals, read_pixels
from normalgan.inference.reading.hint_files import load_hints
from normalgan.normals import Green, flip_green

__all__ = ["LAYOUTS", "PairFiles", "find_pairs"]

_NORMAL_SUFFIXES = (".png", ".exr", ".tif", ".tiff", ".webp", ".jpg", ".jpeg", ".bmp")
"""What a normal map's file may end in, in the order in which it is looked for."""
_COLUMNS = ("sketch", "normal", "mask", "hints", "group", "split", "name")
"""The columns of a CSV; the first two it must have."""

_FOLDERS = {
    "sketch": ("sketch", "sketches"),
    "normal": ("normal", "normals"),
    "mask": ("mask", "masks"),
    "hints": ("hints", "hint"),
}
_ENDS_IN = {"normal": _NORMAL_SUFFIXES, "mask": (".png", ".webp", ".bmp"), "hints": (".png", ".json")}
_ZERO = 0.05
"""A shorter vector means that there is no object, in 8 bits too."""
_PARTNERS = tuple(f"_{kind}" for kind in _ENDS_IN)
LAYOUTS = (
    "a pair is a.png with a_normal.png beside it, or sketch/a.png with normal/a.png in the folder next to "
    "it, or A/a.png with B/a.png, or one picture of both, side by side, in AB; the last two also in train, "
    "val and test below these"
)
"""How pairs may lie on disk, for messages."""


@dataclass(frozen=True)
class PairFiles:
    """A pair on disk.

    Args:
        name: what it is called.
        sketch: its sketch, of any format that is read.
        normal: its normal map.
        mask: where the object is; None derives it from the normal map's opacity or background.
        hints: normals that a designer gave, PNG or JSON; None for none.
        green: direction of y in the normal map and in painted hints.
        group: the group that it belongs to.
        part: its split; None if it is not given.
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
            digest.update(b"none" if path is None else hashlib.sha256(read_named(path)).digest())
        return digest.hexdigest()

    def load(self) -> Pair:
        """Return the pair.

        Raises:
            InputError: if a file cannot be used, or the files do not match.
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


def find_pairs(entry: str, left_out: list[str]) -> Iterator[PairFiles]:
    """Yield the pairs at a folder, a file or a glob; record files without a partner.

    Args:
        entry: the folder, the file or the glob.
        left_out: gets a sentence for each file that has no partner.

    Raises:
        InputError: if there is no sketch, or a CSV cannot be used.
    """
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
        raise InputError(f"{kind} is at {entry}; {LAYOUTS}{more}.")
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
    return sorted(path for path in folder.iterdir() if path.suffix.lower() in _NORMAL_SUFFIXES)


def _in_part(part: str | None, path: Path) -> str:
    return f"{part}/{path.stem}" if part else path.stem


def _is_double(path: Path) -> bool:
    """Return whether a picture is twice as wide as high, as one of sketch and normal map is."""
    height, width = read_pixels(path).pixels.shape[:2]
    return bool(width == 2 * height)


def _name(sketch: Path, root: Path) -> str:
    """Return the name of a pair: the path of its sketch without the parts that mark it as one."""
    try:
        folders = sketch.parent.relative_to(root).parts
    except ValueError:
        folders = ()
    kept = [folder for folder in folders if folder.lower() not in _FOLDERS["sketch"]]
    return "/".join([*kept, sketch.stem.removesuffix("_sketch")])


def _partner(sketch: Path, kind: str) -> Path | None:
    """Return a sketch's file of a kind; None if it has none."""
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
        is_normal = path.suffix.lower() in _NORMAL_SUFFIXES and (inner or path.stem.endswith("_normal"))
        if is_normal and not path.name.startswith(".") and path not in partners:
            yield path


def _subfolder(folder: Path, kind: str) -> Path | None:
    return next((folder / name for name in _FOLDERS[kind] if (folder / name).is_dir()), None)


def _is_partner(path: Path) -> bool:
    others = {name for kind in _ENDS_IN for name in _FOLDERS[kind]}
    return path.stem.endswith(_PARTNERS) or path.parent.name.lower() in others


def _listed(path: Path, left_out: list[str]) -> Iterator[PairFiles]:
    """Yield the pairs in a CSV, whose paths start from its folder; note those that lack a file."""
    right = (
        f"its first line names columns, {', '.join(_COLUMNS[:2])} and optionally {', '.join(_COLUMNS[2:])}"
    )
    try:
        text = read_named(path).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path} is not a text in UTF-8; {right}.") from None
    reader = csv.DictReader(io.StringIO(text), skipinitialspace=True)
    try:
        columns = list(reader.fieldnames or [])
        rows = [(reader.line_num, row) for row in reader]
    except csv.Error as error:
        raise InputError(f"{path} is not CSV ({error}); {right}.") from None
    if unknown := [column for column in columns if column not in _COLUMNS]:
        raise InputError(
            f"{path} has a column {unknown[0]!r}, which is unknown."
            f"{did_you_mean(unknown[0], _COLUMNS)} {right[0].upper()}{right[1:]}."
        )
    if missing := [column for column in _COLUMNS[:2] if column not in columns]:
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
    """Return the object of a normal map without a mask: its opaque part, or all but its background."""
    found = alpha > 0.5 if alpha is not None and float(alpha.min()) <= 0.5 else ~background(vectors)
    found = np.asarray(found & (np.linalg.norm(vectors, axis=-1) > _ZERO))
    if not found.any():
        raise InputError("the normal map shows nothing but its background.")
    return found
