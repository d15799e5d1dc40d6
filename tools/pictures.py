"""Makes the pictures of the documentation from embedded animals and a sphere: tools/pictures.py FOLDER."""

import sys
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
import torch
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray

from normalgan.animals import GROUPS, Animal
from normalgan.files.writing import write_bytes
from normalgan.hints import CurvatureHints
from normalgan.normals import encode, flip_green, paint_flat
from normalgan.rendering import EmbreeRenderer, Maps
from normalgan.rendering.lines import LineDrawing, SuggestiveContours
from normalgan.rendering.strokes import rasterise
from normalgan.rendering.view import View
from normalgan.rendering.views import framed, look_at_origin

Picture = NDArray[np.floating]
DPI = 100


def look(animal: Animal, size: int, azimuth: float = 25.0, elevation: float = 10.0) -> View:
    """Return a view of an animal, orthographic, ``size`` pixels a side."""
    mesh = animal.load()
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
    """Return the maps of a sphere that leaves a tenth of the frame free at each side."""
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
    """Return a figure as the bytes of a PNG file, with nothing in it that changes from day to day."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    return buffer.getvalue()


def herd() -> bytes:
    """Return one quadruped of each species, and a second horse: normal maps above sketches."""
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
    """Return the way from a normal map to the hints of the paper: levels, thresholds, XOR, dropout."""
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
    for row, column in np.argwhere(kept):  # a hint is one pixel; five by five can be seen
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


def conventions() -> bytes:
    """Return a sphere's normal map with axes and colours, its channels, and its green-flipped twin."""
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
    """Draw the axes of the camera, and the colours of the normals along them."""
    middle, reach = 199.5, 160.0
    for (dx, dy), name in {(1, 0): "x", (0, -1): "y"}.items():
        tip = (middle + reach * 1.12 * dx, middle + reach * 1.12 * dy)
        axes.annotate("", tip, (middle, middle), arrowprops={"arrowstyle": "->", "linewidth": 1.6})
        axes.text(tip[0] + 8 * dx - 14 * abs(dy), tip[1] - 14 * dx, name, fontsize=12, weight="bold")
    axes.add_patch(Circle((middle, middle), 9, fill=False, linewidth=1.6))
    axes.plot(middle, middle, "k.", markersize=4)
    axes.text(middle - 16, middle + 6, "z, to you", fontsize=11, weight="bold", ha="right")
    # Where the normal lies along an axis: on the rim, beside the arrows.
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


if __name__ == "__main__":
    torch.set_num_threads(1)
    folder = Path(sys.argv[1]) if len(sys.argv) == 2 else sys.exit("usage: tools/pictures.py FOLDER")
    for make in (herd, curvature, conventions):
        path = folder / f"{make.__name__}.png"
        write_bytes(path, make())
        print(path, f"{path.stat().st_size // 1024} kB")
