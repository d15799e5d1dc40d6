"""Makes the documentation's pictures from embedded animals and a sphere: tools/pictures.py FOLDER [NAME ...].

With names of `PICTURES` after the folder, it makes only these; all of them take some minutes.
"""

import sys
from collections.abc import Callable, Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
import torch
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray
from PIL import Image

from normalgan.animals import GROUPS, Animal
from normalgan.files.writing import write_bytes
from normalgan.hints import CurvatureHints
from normalgan.inference.reading.drawings import read_drawing
from normalgan.inference.reading.picture import resize
from normalgan.normals import encode, flip_green, paint_flat
from normalgan.rendering import EmbreeRenderer, Maps, MeshSource
from normalgan.rendering.cameras import framed, look_at_origin
from normalgan.rendering.hand import Hand
from normalgan.rendering.lines import (
    Brush,
    LineDrawing,
    ObjectSpaceSuggestive,
    OccludingContours,
    RidgesAndValleys,
    Silhouette,
    SuggestiveContours,
)
from normalgan.rendering.strokes import rasterise
from normalgan.rendering.variation import Variation, Varied
from normalgan.rendering.view import View

Picture = NDArray[np.floating]
DPI = 100
SKETCHES = Path(__file__).parents[1] / "examples" / "sketches"


def look(source: MeshSource, size: int, azimuth: float = 25.0, elevation: float = 10.0) -> View:
    """Return a view of an animal, orthographic, ``size`` pixels a side."""
    mesh = source.load()
    camera = framed(mesh.vertices, look_at_origin(azimuth, elevation, 0.0), None, 0.04)
    return View(mesh, camera, EmbreeRenderer(), size)


def render(animal: Animal, size: int, azimuth: float = 25.0) -> Maps:
    """Return the maps of an animal, ``size`` pixels a side."""
    return look(animal, size, azimuth).maps()


def draw(animal: Animal, lines: LineDrawing, size: int, azimuth: float = 25.0) -> Picture:
    """Return an animal's sketch (size, size), paper 1 and ink 0."""
    strokes = lines.trace(look(animal, size, azimuth), np.random.default_rng(0))
    return 1 - rasterise(strokes, size).astype(np.float64)


def colours(maps: Maps) -> Picture:
    """Return a normal map as a file shows it, (H, W, 3) in [0, 1]."""
    return encode(paint_flat(maps.normal, maps.mask)) / 255


def sphere(size: int) -> Maps:
    """Return the maps of a sphere with a margin of a tenth of the frame on each side."""
    y, x = np.mgrid[1 : -1 : size * 1j, -1 : 1 : size * 1j] / 0.8
    z = np.sqrt(np.clip(1 - x * x - y * y, 0, None))
    mask = x * x + y * y < 1
    normal = (np.stack([x, y, z], axis=-1) * mask[..., None]).astype(np.float32)
    return Maps(normal, np.where(mask, 2 - z, np.inf).astype(np.float32), mask)


def panels(rows: Sequence[Sequence[Picture]], titles: Sequence[Sequence[str]], side: int) -> bytes:
    """Return pictures in rows, each ``side`` pixels wide under its title, as a PNG."""
    title = 22
    height, width = len(rows) * (side + title), len(rows[0]) * side
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI)
    for j, (row, names) in enumerate(zip(rows, titles, strict=True)):
        for i, (picture, name) in enumerate(zip(row, names, strict=True)):
            bottom = height - (j + 1) * (side + title)
            axes = figure.add_axes((i * side / width, bottom / height, side / width, side / height))
            axes.imshow(picture, cmap="gray", vmin=0, vmax=1, interpolation="nearest")
            axes.set_axis_off()
            axes.set_title(name, fontsize=9, pad=5)
    return png(figure)


def png(figure: Figure) -> bytes:
    """Return a figure as reproducible PNG bytes, without dates or versions."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    return buffer.getvalue()


def herd() -> bytes:
    """Return one quadruped of each species and a second horse, normal maps above sketches."""
    animals = [Animal(species, 1) for species in GROUPS["quadrupeds"]] + [Animal("horse", 2)]
    size, rows, names = 128, [], []
    for some in (animals[:8], animals[8:]):
        rows += [
            [colours(render(animal, size)) for animal in some],
            [draw(animal, SuggestiveContours(), size) for animal in some],
        ]
        names += [[animal.name for animal in some], [""] * len(some)]
    return panels(rows, names, size)


def curvature() -> bytes:
    """Return the steps from a normal map to the paper's hints: levels, thresholds, XOR, dropout."""
    animal, size = Animal("horse", 2), 256
    maps = render(animal, size, azimuth=-30.0)
    normal = torch.from_numpy(maps.normal).permute(2, 0, 1)[None]
    mask = torch.from_numpy(maps.mask)[None, None].float()
    sampler = CurvatureHints()
    levels = sampler.levels(normal)[0, 0].numpy()
    selected = sampler.select(normal, mask)[0, 0].numpy()
    kept = sampler.sample(normal, mask, torch.Generator().manual_seed(0))[0, 0].numpy() > 0.5
    sketch = draw(animal, SuggestiveContours(), size, azimuth=-30.0)
    hinted = np.repeat(0.6 + 0.4 * sketch[..., None], 3, axis=-1)
    for row, column in np.argwhere(kept):  # a hint is a single pixel, drawn as five by five to be visible
        hinted[row - 2 : row + 3, column - 2 : column + 3] = encode(maps.normal[row, column]) / 255
    pictures = [
        colours(maps),
        np.clip((levels - 128) / 16 + 0.5, 0, 1),
        1.0 - (levels <= 127),
        1.0 - selected,
        hinted,
    ]
    titles = [
        "normal map",
        "curvature levels, 128 ± 8",
        f"at most 127: {np.sum(levels <= 127)}",
        f"XOR, exactly 127: {selected.sum()}",
        f"5 % kept: {kept.sum()} hints (enlarged)",
    ]
    return panels([pictures], [titles], size)


def hand() -> bytes:
    """Return animals drawn by hands of growing strength, and finally the normals of the last drawing."""
    strengths, size, rows = (0.0, 0.25, 0.5, 1.0, 1.0, 1.0), 140, []
    seen = ((("horse", 2), 30.0), (("lion", 3), -50.0), (("elephant", 1), -35.0), (("cat", 1), 100.0))
    for (species, seed), azimuth in seen:
        view = look(Animal(species, seed), size, azimuth, 8.0)
        strokes = SuggestiveContours().trace(view, np.random.default_rng(0))
        row: list[Picture] = []
        for number, strength in enumerate(strengths):
            person = Hand(strength=(strength, strength))
            drawn, maps = person.draw(strokes, view.maps(), np.random.default_rng(number))
            row.append(1 - rasterise(drawn, size).astype(np.float64))
        rows.append([*row, colours(maps)])
    titles = ["strength 0", *(f"{strength:g}" for strength in strengths[1:]), "the last one's normals"]
    return panels(rows, [titles, *([""] * len(titles) for _ in rows[1:])], size)


def styles() -> bytes:
    """Return rows of animals drawn in every style, and below them drawings by people."""
    kinds: tuple[type[LineDrawing], ...] = (Silhouette, OccludingContours, SuggestiveContours)
    kinds += (ObjectSpaceSuggestive, RidgesAndValleys, Brush)
    seen = ((("lion", 3), 25.0), (("horse", 2), -30.0), (("elephant", 1), 20.0), (("cat", 1), 60.0))
    size = 224
    rows = [[draw(Animal(*animal), kind(), size, azimuth) for kind in kinds] for animal, azimuth in seen]
    people = [1 - resize(read_drawing(path), (size, size)) for path in sorted(SKETCHES.glob("*.png"))]
    rows.append([*people, *[np.ones((size, size))] * (len(kinds) - len(people))])
    blank = [""] * len(kinds)
    below = ["by people, to compare:", *blank[1:]]
    picture = panels(rows, [[kind.__name__ for kind in kinds], blank, blank, blank, below], size)
    grey = BytesIO()
    # Sixteen greys take a third of the bytes, with no visible difference.
    Image.open(BytesIO(picture)).convert("L").quantize(16).save(grey, format="png", optimize=True)
    return grey.getvalue()


def kinds() -> bytes:
    """Return 64 species, as evenly from all groups as these allow, in the order of the groups."""
    rounds = max(len(names) for names in GROUPS.values())
    dealt = [name for i in range(rounds) for names in GROUPS.values() for name in names[i : i + 1]][:64]
    animals = [Animal(name, 1) for names in GROUPS.values() for name in names if name in dealt]
    return contact_sheet(animals, 88, azimuth=32.0, elevation=16.0)


def variation() -> bytes:
    """Return two rows for each of four animals: the animal itself, and varied individuals."""
    found: list[MeshSource] = []
    for species in ("horse", "cat", "elephant", "stag"):
        animal = Animal(species, 1)
        found += [animal, *(Varied(animal, Variation(), number) for number in range(15))]
    return contact_sheet(found, 120, azimuth=25.0, elevation=12.0)


def contact_sheet(found: Sequence[MeshSource], side: int, azimuth: float, elevation: float) -> bytes:
    """Return the normal maps of meshes as a PNG with few colours, eight maps in a row."""
    maps = [look(source, side, azimuth, elevation).maps() for source in found]
    tiles = [encode(paint_flat(each.normal, each.mask)) for each in maps]
    rows = [np.concatenate(tiles[i : i + 8], axis=1) for i in range(0, len(tiles), 8)]
    buffer = BytesIO()
    picture = Image.fromarray(np.concatenate(rows, axis=0).astype(np.uint8))
    picture.quantize(224).save(buffer, format="png", optimize=True)
    return buffer.getvalue()


def conventions() -> bytes:
    """Return a sphere's normal map with axes and colours, its channels, and its green-flipped copy."""
    figure = Figure(figsize=(11.0, 3.9), dpi=DPI)
    grid = figure.add_gridspec(2, 4, width_ratios=(2, 1, 1, 2), wspace=0.08, hspace=0.22)
    figure.subplots_adjust(left=0.01, right=0.99, top=0.92, bottom=0.03)
    maps = sphere(400)
    left = figure.add_subplot(grid[:, 0])
    _show(left, colours(maps), "y up (OpenGL): what normalgan reads and writes")
    _axes(left)
    picture = colours(maps)
    flat = Maps(np.zeros_like(maps.normal), maps.depth, np.zeros_like(maps.mask))
    cells = ((0, 1, "red = x"), (0, 2, "green = y"), (1, 1, "blue = z"))
    for channel, (row, column, name) in enumerate(cells):
        _show(figure.add_subplot(grid[row, column]), picture[..., channel], name)
    _show(figure.add_subplot(grid[1, 2]), colours(flat), "flat: 128, 128, 255")
    flipped = encode(paint_flat(flip_green(maps.normal), maps.mask)) / 255
    _show(figure.add_subplot(grid[:, 3]), flipped, "y down (DirectX): green flipped")
    return png(figure)


def _show(axes: Axes, picture: Picture, title: str) -> None:
    axes.imshow(picture, cmap="gray", vmin=0, vmax=1)
    axes.set_title(title, fontsize=9)
    axes.set_axis_off()


def _axes(axes: Axes) -> None:
    """Draw the camera's axes, and the colours of the normals along them."""
    middle, reach = 199.5, 160.0
    for (dx, dy), name in {(1, 0): "x", (0, -1): "y"}.items():
        tip = (middle + reach * 1.12 * dx, middle + reach * 1.12 * dy)
        axes.annotate("", tip, (middle, middle), arrowprops={"arrowstyle": "->", "linewidth": 1.6})
        axes.text(tip[0] + 8 * dx - 14 * abs(dy), tip[1] - 14 * dx, name, fontsize=12, weight="bold")
    axes.add_patch(Circle((middle, middle), 9, fill=False, linewidth=1.6))
    axes.plot(middle, middle, "k.", markersize=4)
    axes.text(middle - 16, middle + 6, "z, to you", fontsize=11, weight="bold", ha="right")
    # The colours of normals along an axis lie on the rim, next to the arrows.
    labels = (
        (reach - 6.0, 26.0, "right", (1, 0, 0)),
        (6.0 - reach, -16.0, "left", (-1, 0, 0)),
        (12.0, 24.0 - reach, "left", (0, 1, 0)),
        (0.0, reach - 12.0, "center", (0, -1, 0)),
    )
    for right, down, side, normal in labels:
        colour = ", ".join(map(str, encode(np.array(normal, dtype=np.float64)).tolist()))
        dark = normal[1] < 0
        axes.text(
            middle + right, middle + down, colour, fontsize=8.5, ha=side, color="white" if dark else "black"
        )


PICTURES: tuple[Callable[[], bytes], ...] = (herd, curvature, conventions, hand, styles, kinds, variation)

if __name__ == "__main__":
    torch.set_num_threads(1)
    if len(sys.argv) < 2:
        sys.exit("usage: tools/pictures.py FOLDER [NAME ...]")
    for make in PICTURES:
        if make.__name__ in sys.argv[2:] or len(sys.argv) == 2:
            path = Path(sys.argv[1]) / f"{make.__name__}.png"
            write_bytes(path, make())
            print(path, f"{path.stat().st_size // 1024} kB")
