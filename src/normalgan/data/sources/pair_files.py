"""Files of pairs: finding them in a folder, by a glob or in a CSV, and reading them."""

import csv
import hashlib
import io
import json
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from glob import has_magic
from os.path import commonpath
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from normalgan.arrays import BoolMask
from normalgan.data.sources.pair import PAIRS_VERSION, Pair, background
from normalgan.data.splits import SPLITS
from normalgan.errors import InputError, did_you_mean, with_subject
from normalgan.files.globs import matches
from normalgan.files.limits import read_named
from normalgan.inference.inputs import AnyPicture, as_picture
from normalgan.inference.reading.drawings import is_drawing, read_normals, read_pixels
from normalgan.inference.reading.hint_files import load_hints
from normalgan.inference.reading.picture import MOST_WORKED, to_picture
from normalgan.normals import Green, flip_green

TABLES = (".csv", ".tsv")
"""File extensions of lists of pairs."""
_NORMAL_SUFFIXES = (".png", ".exr", ".tif", ".tiff", ".webp", ".jpg", ".jpeg", ".bmp")
"""File extensions of normal maps, in search order."""
_COLUMNS = ("sketch", "normal", "mask", "hints", "group", "split", "name")
"""The columns of a CSV; the first two are required."""

_FOLDERS = {
    "sketch": ("sketch", "sketches"),
    "normal": ("normal", "normals"),
    "mask": ("mask", "masks"),
    "hints": ("hints", "hint"),
}
_ENDS_IN = {"normal": _NORMAL_SUFFIXES, "mask": (".png", ".webp", ".bmp"), "hints": (".png", ".json")}
_HEADERS = ("PNG", "JPEG", "BMP", "TIFF", "GIF")
"""Formats with headers that Pillow reads in pure Python; others are opened only by the decoding process."""
_ZERO = 0.05
"""Shorter vectors mean background, even in 8 bits."""
_PARTNERS = tuple(f"_{kind}" for kind in _ENDS_IN)
Direction = Literal["AtoB", "BtoA"]
"""As in pix2pix: the sketch is the first letter, of folders ``A`` and ``B`` or the left and right half."""
Reason = str
"""Why a file, or a line of a CSV, is left out; a sentence without its full stop."""
LAYOUTS = (
    "a pair is a.png with a_normal.png beside it, or sketch/a.png with normal/a.png in the folder next to "
    "it, or A/a.png with B/a.png, or one picture of both, side by side, in AB; splits are folders train, "
    "val and test, below these or around them"
)
"""Description of the supported layouts on disk, for messages."""


@dataclass(frozen=True)
class PairFiles:
    """A pair on disk.

    Args:
        name: name of the pair.
        sketch: sketch, in any supported format.
        normal: normal map.
        mask: object mask; None derives it from the normal map's opacity or background.
        hints: normals set by a designer, PNG or JSON; None for no hints.
        green: direction of y in the normal map and in painted hints.
        group: group of the pair.
        part: split of the pair; None if it is not given.
        direction: position of the sketch in a side-by-side file: left (``AtoB``) or right (``BtoA``).
    """

    name: str
    sketch: Path
    normal: Path
    mask: Path | None = None
    hints: Path | None = None
    green: Green = "up"
    group: str = ""
    part: str | None = None
    direction: Direction = "AtoB"

    def fingerprint(self) -> str:
        """Return a hash of the files' bytes and the settings.

        Raises:
            InputError: if a file cannot be read.
        """
        turned = [self.direction] if self.direction != "AtoB" else []  # the default keeps old hashes
        digest = hashlib.sha256(json.dumps([PAIRS_VERSION, self.name, self.green, *turned]).encode())
        for path in (self.sketch, self.normal, self.mask, self.hints):
            digest.update(b"none" if path is None else hashlib.sha256(read_named(path)).digest())
        return digest.hexdigest()

    def load(self) -> Pair:
        """Return the pair.

        Raises:
            InputError: if a file is invalid, or the files do not match.
        """
        try:
            return self._loaded()
        except InputError:
            if self._is_exchanged():
                both = self.sketch == self.normal
                what = "shows the normal map where the sketch should be" if both else "is a normal map"
                raise InputError(
                    f"{self.sketch} {what}{'' if both else f', and {self.normal} a sketch'}; exchange them, "
                    "or pass --data.source.direction BtoA (AtoB, the default, takes A, or the left half, for "
                    "the sketch)."
                ) from None
            raise

    def _is_exchanged(self) -> bool:
        """Return whether the files are usable if sketch and normal map are swapped."""
        other: Direction = "BtoA" if self.direction == "AtoB" else "AtoB"
        try:
            replace(
                self, sketch=self.normal, normal=self.sketch, mask=None, hints=None, direction=other
            )._loaded()
        except InputError:
            return False
        return True

    def _loaded(self) -> Pair:
        subject = str(self.normal)
        vectors, alpha = read_normals(self.normal, self.green)
        lossy = self.mask is None and _is_lossy(self.normal)
        if self.sketch == self.normal:  # side by side
            middle = vectors.shape[1] // 2
            left, right = np.s_[:, :middle], np.s_[:, middle:]
            of_sketch, of_normal = (left, right) if self.direction == "AtoB" else (right, left)
            picture: AnyPicture = read_pixels(self.sketch).pixels[of_sketch]
            vectors, alpha = vectors[of_normal], None if alpha is None else alpha[of_normal]
            if lossy:  # its colours bleed over the seam, by the one pixel to which they are enlarged
                edge, inner = (0, 1) if self.direction == "AtoB" else (-1, -2)
                vectors[:, edge] = vectors[:, inner]
            subject = f"the {'right' if self.direction == 'AtoB' else 'left'} half of {self.normal}"
        else:  # an SVG has no pixels of its own
            side = max(vectors.shape[:2])
            picture = to_picture(read_pixels(self.sketch, svg_side=side, longest=MOST_WORKED))
        sketch = as_picture(picture)
        hints = None if self.hints is None else load_hints(self.hints, sketch.shape)
        if hints is not None and self.hints is not None and self.hints.suffix.lower() == ".png":
            hints = replace(hints, normals=flip_green(hints.normals)) if self.green == "down" else hints
        try:
            return Pair(sketch, vectors, self.mask or _object(vectors, alpha, lossy), hints)
        except InputError as error:
            raise with_subject(subject, error) from error


def find_pairs(entry: str, direction: Direction = "AtoB") -> Iterator[PairFiles | Reason]:
    """Yield the pairs at a folder, a file or a glob, and the reasons why other files are left out.

    Args:
        entry: folder, file or glob.
        direction: position of the sketch in pix2pix folders.

    Raises:
        InputError: if there is no sketch, or a CSV is invalid.
    """
    path = Path(entry)
    if not path.exists() and not has_magic(entry):
        raise InputError(f"there is no file or folder {entry}; {LAYOUTS}.")
    if path.is_dir():
        known = list(_pix2pix(path, direction)) or list(_in_split_folders(path, direction))
        yield from known
        if any(isinstance(each, PairFiles) for each in known):
            return
    if path.suffix.lower() in TABLES:
        yield from (_listed(path.parent, where, row) for where, row in _rows(path))
        return
    if path.is_dir():
        inner = _subfolder(path, "sketch")
        within = [each for each in (inner or path).iterdir() if is_drawing(each)]
        sketches = sorted(each for each in within if inner or not _is_partner(each))
        yield from (f"{orphan} has no sketch" for orphan in _orphans(path, inner, sketches))
        root = path
    elif path.is_file():
        if not is_drawing(path):
            raise InputError(
                f"{entry} is neither a picture nor a list of pairs ({', '.join(TABLES)}); {LAYOUTS}."
            )
        sketches, root = [path], path.parent
    else:
        sketches = sorted(
            each for each in matches(entry) if each.is_file() and is_drawing(each) and not _is_partner(each)
        )
        root = Path(commonpath([each.parent for each in sketches])) if sketches else Path()
    if not sketches:
        kind = "an empty folder" if path.is_dir() and not any(path.iterdir()) else "no sketch"
        inside = (each for each in path.glob("**/*") if is_drawing(each)) if path.is_dir() else ()
        below = any(_partner(each, "normal") for each in inside)
        more = f"; those in folders below it are named by a glob, '{entry}/**/*.png'" if below else ""
        if path.name in {"A", "B"} and path.is_dir():
            more = f"; name the folder that holds A and B, {path.parent}"
        raise InputError(f"{kind} is at {entry}; {LAYOUTS}{more}.")
    for sketch in sketches:
        normal = _partner(sketch, "normal")
        if normal is None:
            yield f"{sketch} has no normal map"
            continue
        name = _name(sketch, root)
        yield PairFiles(name, sketch, normal, _partner(sketch, "mask"), _partner(sketch, "hints"))


def _pix2pix(root: Path, direction: Direction) -> Iterator[PairFiles | Reason]:
    """Yield the pairs of a pix2pix folder: ``A`` and ``B``, or side-by-side pictures in ``AB``.

    The subfolders ``train``, ``val`` and ``test`` are the splits. ``trainA`` and ``trainB`` are read too.
    Without a folder ``AB``, if a picture in one of the splits is twice as wide as high, all of them are read
    as side-by-side pairs.
    """
    sketches, normals = (root / name for name in ("AB" if direction == "AtoB" else "BA"))
    both = root / "AB"
    bare = not both.is_dir() and any(
        _is_double(path) for part in SPLITS if (root / part).is_dir() for path in _pictures(root / part)
    )
    for part in (None, *SPLITS):
        below = part or "."
        if (sketches / below).is_dir() and (normals / below).is_dir():
            yield from _same_stems(sketches / below, normals / below, part)
        elif not sketches.is_dir() and ((both / below).is_dir() or (part and bare)):
            yield from _side_by_side(both / below if both.is_dir() else root / below, part, direction)
        letters = "AB" if direction == "AtoB" else "BA"
        first, second = (root / f"{part}{letter}" for letter in letters)
        if part and first.is_dir() and second.is_dir():
            yield from _same_stems(first, second, part)


def _in_split_folders(root: Path, direction: Direction) -> Iterator[PairFiles | Reason]:
    """Yield the pairs of folders ``train``, ``val`` and ``test``, each of which has another layout inside."""
    if _subfolder(root, "sketch") or any(map(is_drawing, root.iterdir())):
        return
    for part in SPLITS:
        if not (root / part).is_dir() or not any((root / part).iterdir()):
            continue
        for found in find_pairs(str(root / part), direction):
            if isinstance(found, PairFiles):
                yield replace(found, name=f"{part}/{found.name}", part=part)
            else:
                yield found


def _same_stems(sketches: Path, normals: Path, part: str | None) -> Iterator[PairFiles | Reason]:
    """Yield the pairs of a folder of sketches and a folder of normal maps with the same names."""
    of_stem = {path.stem: path for path in _pictures(normals)}
    for sketch in sorted(filter(is_drawing, sketches.iterdir())):
        normal = of_stem.pop(sketch.stem, None)
        if normal is None:
            yield f"{sketch} has no normal map"
        else:
            yield PairFiles(_in_part(part, sketch), sketch, normal, part=part)
    yield from (f"{normal} has no sketch" for normal in of_stem.values())


def _side_by_side(folder: Path, part: str | None, direction: Direction) -> Iterator[PairFiles | Reason]:
    """Yield the pairs of a folder of pictures that show sketch and normal map side by side."""
    for picture in _pictures(folder) if folder.is_dir() else []:
        size = header_size(picture)
        if size is not None and size[0] % 2:
            yield (
                f"{picture} is {size[0]} pixels wide, which has no half; it must show sketch and normal map "
                "side by side"
            )
        else:
            yield PairFiles(_in_part(part, picture), picture, picture, part=part, direction=direction)


def _pictures(folder: Path) -> list[Path]:
    return sorted(
        path
        for path in folder.iterdir()
        if path.suffix.lower() in _NORMAL_SUFFIXES and not path.name.startswith(".")
    )


def _in_part(part: str | None, path: Path) -> str:
    return f"{part}/{path.stem}" if part else path.stem


def _is_double(path: Path) -> bool:
    """Return whether a picture is twice as wide as high, like a side-by-side pair."""
    size = header_size(path)
    if size is None:  # not a known format
        try:
            height, width = read_pixels(path).pixels.shape[:2]
        except InputError:
            return False
        size = width, height
    return size[0] == 2 * size[1]


def header_size(path: Path) -> tuple[int, int] | None:
    """Return width and height from a picture's header, or None if it cannot be read."""
    try:
        with warnings.catch_warnings(action="ignore"), Image.open(path, formats=_HEADERS) as picture:
            return picture.size
    except Exception:  # a damaged file may raise anything
        return None


def _name(sketch: Path, root: Path) -> str:
    """Return the name of a pair: the path of its sketch without the parts that mark it as a sketch."""
    try:
        folders = sketch.parent.relative_to(root).parts
    except ValueError:
        folders = ()
    kept = [folder for folder in folders if folder.lower() not in _FOLDERS["sketch"]]
    return "/".join([*kept, sketch.stem.removesuffix("_sketch")])


def _partner(sketch: Path, kind: str) -> Path | None:
    """Return a sketch's companion file of a kind, or None if there is none."""
    stem = sketch.stem.removesuffix("_sketch")
    endings = [each for ending in _ENDS_IN[kind] for each in (ending, ending.upper())]
    beside = [sketch.with_name(f"{stem}_{kind}{ending}") for ending in endings]
    if sketch.parent.name.lower() in _FOLDERS["sketch"]:
        folder = _subfolder(sketch.parent.parent, kind)
        if folder is not None:
            stems = [sketch.stem, stem, f"{stem}_{kind}"]
            beside += [folder / f"{name}{ending}" for name in stems for ending in endings]
    return next((path for path in beside if path.is_file()), None)


def _orphans(folder: Path, inner: Path | None, sketches: Sequence[Path]) -> Iterator[Path]:
    """Yield the normal maps of a folder that have no sketch."""
    partners = {_partner(sketch, "normal") for sketch in sketches}
    where = _subfolder(folder, "normal") if inner else folder
    for path in sorted(where.iterdir()) if where else []:
        is_normal = path.suffix.lower() in _NORMAL_SUFFIXES and (inner or path.stem.endswith("_normal"))
        if is_normal and not path.name.startswith(".") and path not in partners:
            yield path


def _subfolder(folder: Path, kind: str) -> Path | None:
    """Return the subfolder of a kind, in upper or lower case, or None if there is none."""
    of_name = {each.name.lower(): each for each in sorted(folder.iterdir()) if each.is_dir()}
    return next((of_name[name] for name in _FOLDERS[kind] if name in of_name), None)


def _is_partner(path: Path) -> bool:
    """Return whether a file is the normal map, the mask or the hints of a sketch, by its place."""
    others = {name for kind in _ENDS_IN for name in _FOLDERS[kind]}
    if path.stem.endswith(_PARTNERS):
        return True
    return (
        path.parent.name.lower() in others and _subfolder(path.absolute().parent.parent, "sketch") is not None
    )


def _rows(path: Path) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield the rows of a CSV of pairs, each with its place for messages."""
    right = (
        f"its first line names columns, {', '.join(_COLUMNS[:2])} and optionally {', '.join(_COLUMNS[2:])}"
    )
    try:
        text = read_named(path).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path} is not UTF-8 text; {right}.") from None
    first = text.partition("\n")[0]
    # Spreadsheets separate by semicolons where the comma is the decimal mark.
    delimiter = next((each for each in ",;\t" if each in first), ",")
    reader = csv.DictReader(io.StringIO(text), skipinitialspace=True, delimiter=delimiter)
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
        yield where, row


def _listed(folder: Path, where: str, row: dict[str, str]) -> PairFiles | Reason:
    """Return the pair in a row of a CSV, or the reason why it is left out.

    Args:
        folder: folder of the CSV, to which its paths are relative.
        where: place of the row for messages.
        row: values by column.

    Raises:
        InputError: if a value is invalid.
    """
    part = row.get("split") or None
    if part is not None and part not in SPLITS:
        raise InputError(f"{where} has the split {part!r}; it is {', '.join(SPLITS)}, or empty.")
    files = {kind: folder / row[kind] if row.get(kind) else None for kind in _FOLDERS}
    sketch, normal, mask, hints = files.values()
    if sketch is None or normal is None:
        raise InputError(f"{where} names no {'sketch' if sketch is None else 'normal'}; a pair has both.")
    for kind, file in files.items():
        if file is not None and not file.is_file():
            return f"{where} names {row[kind]} as {kind}, and there is no file {file}"
    name = row.get("name") or _name(Path(row["sketch"]), Path())
    return PairFiles(name, sketch, normal, mask, hints, group=row.get("group", ""), part=part)


def _is_lossy(path: Path) -> bool:
    """Return whether a picture was compressed with loss, as a JPEG or a lossy WebP."""
    with path.open("rb") as file:
        start = file.read(16)
    return start.startswith(b"\xff\xd8") or start[8:] == b"WEBPVP8 "


def _object(vectors: NDArray[np.floating], alpha: NDArray[np.floating] | None, lossy: bool) -> BoolMask:
    """Return the object of a normal map without a mask: the opaque part, or all but the background.

    Pixels that are not finite are background: renderers write NaN where there is no surface.
    """
    found = alpha > 0.5 if alpha is not None and float(alpha.min()) <= 0.5 else ~background(vectors, lossy)
    length = np.linalg.norm(vectors, axis=-1)
    found = np.asarray(found & np.isfinite(length) & (length > _ZERO))
    if not found.any():
        raise InputError("the normal map shows nothing but its background.")
    return found
