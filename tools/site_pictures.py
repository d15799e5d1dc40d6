"""Makes the pictures for the site's pages from embedded animals: tools/site_pictures.py docs/pictures."""

import sys
import tempfile
from io import BytesIO
from pathlib import Path

import numpy as np
import torch
import trimesh
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch
from pictures import Picture, colours, draw, panels, png, render, sphere
from PIL import Image

from normalgan.animals import Animal
from normalgan.arrays import BoolMask
from normalgan.files.writing import write_bytes
from normalgan.hints import CurvatureHints
from normalgan.inference.heights.height import integrate
from normalgan.inference.outputs.preview import lit
from normalgan.normals import decode, encode, flip_green, paint_flat
from normalgan.rendering import EmbreeRenderer, Maps, MeshFile
from normalgan.rendering.cameras import framed, look_at_origin
from normalgan.rendering.lines import SuggestiveContours

FOX, SIZE, TURN = Animal("fox", 4), 256, 40.0


def ball(size: int = 128) -> bytes:
    """Return the package's logo: a sphere's normal map on a transparent ground, with a smooth edge."""
    maps = sphere(size * 5)
    rgba = np.rint(np.dstack([colours(maps), maps.mask]) * 255).astype(np.uint8)
    edge = size // 2
    ball = Image.fromarray(rgba, "RGBA").crop((edge, edge, size * 5 - edge, size * 5 - edge))
    buffer = BytesIO()
    ball.resize((size, size), Image.Resampling.BOX).save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


def lamp(normals: Picture, mask: BoolMask) -> Picture:
    """Return a map rendered as clay lit from the upper left, as in an engine."""
    return lit(normals.astype(np.float32), mask, 125.0) / 255


def light() -> bytes:
    """Return a lit map read correctly, and read in the two most common wrong ways."""
    maps = render(FOX, SIZE, TURN)
    flat = paint_flat(maps.normal, maps.mask)
    stored = encode(flat) / 255
    linear = np.where(stored <= 0.04045, stored / 12.92, ((stored + 0.055) / 1.055) ** 2.4)
    bent = decode(np.rint(linear * 255).astype(np.uint8))
    pictures = [stored, lamp(flat, maps.mask), lamp(flip_green(flat), maps.mask), lamp(bent, maps.mask)]
    names = [
        "the file",
        "read rightly, lit from the upper left",
        "green taken for the other",
        "taken for sRGB colours",
    ]
    return panels([pictures], [names], SIZE)


def outputs() -> bytes:
    """Return the outputs for a drawing: its map, the map with flipped green, the lit map, the heights."""
    maps = render(FOX, SIZE, TURN)
    flat = paint_flat(maps.normal, maps.mask)
    height = integrate(maps.normal, maps.mask)
    low, high = np.percentile(height[maps.mask], [1, 99])
    grey = np.where(maps.mask, 0.15 + 0.85 * np.clip((height - low) / (high - low), 0, 1), 0)
    pictures = [
        draw(FOX, SuggestiveContours(), SIZE, TURN),
        encode(flat) / 255,
        encode(flip_green(flat)) / 255,
        lamp(flat, maps.mask),
        grey,
    ]
    return panels(
        [pictures], [["drawing", "map, --y up", "map, --y down", "--preview", "--height"]], SIZE - 56
    )


def creases() -> bytes:
    """Return a machine part with all edges smoothed, and with its sharp edges kept."""
    body = trimesh.creation.box((2.0, 0.7, 1.2))
    wheel = trimesh.creation.cylinder(
        0.45, 0.5, 32, transform=trimesh.transformations.translation_matrix((0.4, 0.55, 0))
    )
    wheel.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0), (0.4, 0.55, 0)))
    pictures: list[Picture] = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.ply"
        trimesh.util.concatenate([body, wheel]).export(path)
        for angle in (None, 40.0):
            mesh = MeshFile(str(path), crease_angle=angle).load()
            camera = framed(mesh.vertices, look_at_origin(30.0, 25.0, 0.0), None, 0.04)
            pictures.append(colours(EmbreeRenderer().render(mesh, camera, SIZE)))
    return panels([pictures], [["by default: all smooth", "--data.reading.crease_angle 40"]], SIZE)


def flow() -> bytes:
    """Return the flow of data: mesh, normal map, sketch and hints, through the generator, to a map."""
    figure = Figure(figsize=(11.0, 3.9), dpi=100)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_xlim(0, 11)
    axes.set_ylim(0, 3.9)
    axes.set_axis_off()
    maps = render(FOX, SIZE, TURN)
    _picture(axes, (0.15, 1.2), lamp(maps.normal, maps.mask), "mesh")
    _picture(axes, (2.6, 2.15), colours(maps), "normal map")
    _picture(axes, (2.6, 0.15), draw(FOX, SuggestiveContours(), SIZE, TURN), "sketch")
    _picture(axes, (5.05, 1.75), _hints(maps), "hints: a few true normals")
    for start, end, word in (
        ((1.7, 2.2), (2.55, 2.8), "render"),
        ((1.7, 1.7), (2.55, 1.1), "draw"),
        ((4.15, 2.85), (5.0, 2.55), "sample"),
        ((6.6, 2.4), (7.35, 2.4), ""),
        ((4.15, 0.9), (7.35, 1.75), ""),
        ((8.85, 2.1), (9.45, 2.1), ""),
    ):
        axes.add_patch(
            FancyArrowPatch(
                start, end, arrowstyle="-|>", mutation_scale=14, color="#4a4ac4", linewidth=1.6, zorder=3
            )
        )
        axes.text((start[0] + end[0]) / 2, (start[1] + end[1]) / 2 + 0.14, word, fontsize=9, ha="center")
    _box(axes, (7.4, 1.5), "generator", "paints a map")
    _box(axes, (9.5, 1.5), "painted map", "losses, metrics,\nPNG, ONNX")
    return png(figure)


def _picture(axes: Axes, corner: tuple[float, float], picture: Picture, name: str) -> None:
    x, y = corner
    axes.imshow(
        picture, cmap="gray", vmin=0, vmax=1, extent=(x, x + 1.5, y, y + 1.5), aspect="auto", zorder=2
    )
    axes.text(x + 0.75, y + 1.54, name, fontsize=9, ha="center", va="bottom")


def _box(axes: Axes, corner: tuple[float, float], name: str, what: str) -> None:
    axes.add_patch(
        FancyBboxPatch(corner, 1.4, 1.2, boxstyle="round,pad=0.02", facecolor="#ececff", edgecolor="#4a4ac4")
    )
    x, y = corner[0] + 0.7, corner[1]
    axes.text(x, y + 0.85, name, fontsize=10.5, ha="center", weight="bold")
    axes.text(x, y + 0.6, what, fontsize=9, ha="center", va="top")


def _hints(maps: Maps) -> Picture:
    """Return the paper's hints as dots in their colours, large enough to see."""
    normal = torch.from_numpy(maps.normal).permute(2, 0, 1)[None]
    mask = torch.from_numpy(maps.mask)[None, None].float()
    where = CurvatureHints().sample(normal, mask, torch.Generator().manual_seed(1))[0, 0].numpy() > 0.5
    picture = np.where(maps.mask[..., None], 0.86, 1.0) * np.ones(3)
    rows, columns = np.mgrid[:SIZE, :SIZE]
    for row, column in np.argwhere(where):
        dot = (rows - row) ** 2 + (columns - column) ** 2 <= 16
        picture[dot] = encode(maps.normal[row, column]) / 255
    return picture


if __name__ == "__main__":
    torch.set_num_threads(1)
    folder = Path(sys.argv[1]) if len(sys.argv) == 2 else sys.exit("usage: tools/site_pictures.py FOLDER")
    write_bytes(folder.parent / "assets" / "ball.png", ball())
    for make in (light, outputs, creases, flow):
        path = folder / f"{make.__name__}.png"
        write_bytes(path, make())
        print(path, f"{path.stat().st_size // 1024} kB")
