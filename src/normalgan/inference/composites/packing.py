"""Packing: find the drawings of a sheet by a grid, an atlas, a tileset or connected components."""

from dataclasses import dataclass
from pathlib import Path

from normalgan.decoding import Decoded
from normalgan.errors import InputError
from normalgan.inference.composites.atlas import ENDINGS, AtlasCells, read_atlas
from normalgan.inference.composites.islands import find_islands
from normalgan.inference.composites.overlaps import separate
from normalgan.inference.composites.sheets import grid_cells, parse_grid
from normalgan.inference.composites.tile_grid import ENDINGS as TILED
from normalgan.inference.composites.tile_grid import TileGrid, parse_tile_size, read_tiled
from normalgan.inference.reading.drawings import find_companion

OWN = "own"
"""Value of ``tileset`` that selects the tileset stored in the drawing's own file."""

_WAYS = ("sheet", "split", "atlas", "tileset")


@dataclass(frozen=True)
class Packing:
    """The layout of the drawings in a sheet; at most one argument is given.

    Args:
        sheet: a grid as columns x rows, such as 4x3.
        split: auto finds opaque islands, or connected lines in an opaque sheet.
        atlas: an atlas file in any format of `atlas_formats.FORMATS`, or a folder of <sketch>.json or
            similar.
        tileset: the size of a tile, such as 16x16; a Tiled tileset, or a folder of <sketch>.tsx or .tsj; or
            own for the tileset of an Aseprite file.

    Raises:
        InputError: if an argument is invalid, or more than one is given.
    """

    sheet: str | None = None
    split: str | None = None
    atlas: str | None = None
    tileset: str | None = None

    def __post_init__(self) -> None:
        """Raise `InputError` if the packing is invalid."""
        given = [name for name in _WAYS if getattr(self, name) is not None]
        if len(given) > 1:
            raise InputError(
                f"{' and '.join(f'--{each}' for each in given)} each give the positions of the drawings in a "
                "sheet; use only one."
            )
        if self.sheet is not None:
            parse_grid(self.sheet)
        if self.split not in {None, "auto"}:
            raise InputError(f"split is {self.split!r}; the only supported value is auto.")
        if self.atlas is not None and not Path(self.atlas).exists():
            raise InputError(f"there is no atlas {self.atlas}; name an atlas file, or a folder of atlases.")
        if self.tileset not in {None, OWN} and not Path(str(self.tileset)).exists():
            parse_tile_size(str(self.tileset))

    @property
    def given(self) -> bool:
        """Whether drawings are sheets."""
        return any(getattr(self, each) is not None for each in _WAYS)

    def companions(self, path: Path, below: Path | None = None) -> list[Path]:
        """Return the companion files of a sheet: its atlas or tileset file, if there is one.

        Args:
            path: file of the sheet.
            below: subfolder of the atlas folder that is searched first.
        """
        named, endings = (self.atlas, ENDINGS) if self.tileset is None else (self.tileset, TILED)
        found = None if named is None else find_companion(path, Path(named), endings, below)
        return [] if found is None else [found]

    def tile_grid(self, path: Path, below: Path | None = None) -> TileGrid:
        """Return the tile grid of a sheet; the arguments are those of `companions`.

        Raises:
            InputError: if the tileset file is missing or cannot be read.
        """
        assert self.tileset is not None
        if not Path(self.tileset).exists():
            return parse_tile_size(self.tileset)
        found = self.companions(path, below)
        if not found:
            raise InputError(
                f"{self.tileset} has no tileset for {path}; its name must be {path.stem}.tsx, .tsj, .json or "
                ".xml."
            )
        return read_tiled(found[0])

    def cells(
        self, sheet: Decoded, path: Path, below: Path | None = None, units: tuple[float, float] | None = None
    ) -> AtlasCells:
        """Return the cells of a sheet's drawings, with warnings about drawings that are left out.

        Args:
            sheet: pixels of the sheet, not reduced.
            path: file of the sheet.
            below: subfolder of the atlas folder that is searched first.
            units: (width, height) of an SVG in its own units, which its atlas may use.

        Raises:
            InputError: if the sheet has no drawings, or the grid or atlas does not match it.
        """
        if self.sheet is not None:
            return AtlasCells(grid_cells(*parse_grid(self.sheet), sheet.shape, path), [])
        if self.atlas is None:
            return AtlasCells(find_islands(sheet), [])
        found = self.companions(path, below)
        if not found:
            raise InputError(
                f"{self.atlas} has no atlas for {path}; its name must be {path.stem}.json, .xml, .plist, "
                ".atlas, .tpsheet, .png.meta, .txt or .csv."
            )
        read = read_atlas(found[0], sheet.shape, path, units)
        cells, warnings = separate(read.cells, sheet)
        return AtlasCells(cells, [*read.warnings, *warnings])
