"""Sprites: details of the painting on the form, art pixels, outlines; and the options that ask for them."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image, ImageOps

from normal_pngs import read_png
from normalgan.__main__ import main
from normalgan.arrays import Floats
from normalgan.inference.composites.cells import Cell
from normalgan.inference.forms import Form
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.reading.picture import Picture
from normalgan.inference.sprites import DIRECTIONS, Sprite, art_pixel, outlines, slopes_of
from normalgan.normals import angles

SIDE = 32


def ball(side: int = SIDE) -> NormalMap:
    """Return the map of a ball that fills most of a picture."""
    y, x = (np.mgrid[:side, :side] + 0.5 - side / 2) / (0.45 * side)
    inside = x**2 + y**2 <= 1
    z = np.sqrt(np.clip(1 - x**2 - y**2, 0.01, 1))
    normals = np.dstack([x, -y, z]) / np.linalg.norm(np.dstack([x, -y, z]), axis=-1, keepdims=True)
    return NormalMap(
        *(normals.astype(np.float32), inside, inside.astype(np.float32)),
        np.zeros((8, 8), np.float32),
        None,
        (),
    )


def sprite(preds: NormalMap, scale: int = 1) -> Picture:
    """Return a noisy sprite with a dark outline on the ball; an art pixel has ``scale`` pixels a side."""
    small = preds.mask[::scale, ::scale]
    rng = np.random.default_rng(5)
    colour = np.repeat(rng.uniform(0.4, 0.9, (*small.shape, 1)).astype(np.float32), 3, -1)
    inner = cv2.erode(small.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=0) > 0
    colour[small & ~inner] = 0.05
    once = np.ones((scale, scale, 1), np.float32)
    return Picture(np.kron(colour * small[..., None], once), np.kron(small.astype(np.float32), once[..., 0]))


def test_without_details_the_form_is_kept() -> None:
    form = ball()
    assert Sprite()(form, sprite(form)) is form
    plain = Picture(np.full((SIDE, SIDE, 3), 0.6, np.float32), None)
    assert angles(Sprite(detail=1)(form, plain).extended, form.extended).max() < 0.1


def test_a_light_bump_on_a_ball_is_a_bump_on_its_form() -> None:
    """Left of the light spot the surface turns to the left of the form, right of it to the right."""
    form = ball(64)
    colour = np.full((64, 64, 3), 0.4, np.float32)
    colour[28:36, 38:46] = 0.9
    found = Sprite(detail=1)(form, Picture(colour, None))
    assert found.extended[32, 37, 0] < form.extended[32, 37, 0] - 0.2
    assert found.extended[32, 46, 0] > form.extended[32, 46, 0] + 0.1
    assert found.extended[27, 42, 1] > form.extended[27, 42, 1] + 0.1
    assert np.allclose(np.linalg.norm(found.extended, axis=-1), 1, atol=1e-4)
    half = Sprite(detail=0.5)(form, Picture(colour, None))
    turns = [float(angles(each.extended, form.extended)[form.mask].mean()) for each in (half, found)]
    assert 0 < turns[0] < turns[1]


def test_details_do_not_depend_on_the_size_of_the_picture() -> None:
    small = cv2.GaussianBlur(np.random.default_rng(0).random((256, 256), np.float32), (0, 0), 6)
    small = (small - small.min()) / np.ptp(small)
    slopes = [
        slopes_of(np.repeat(each[..., None], 3, -1), np.ones(each.shape, bool))
        for each in (small, cv2.resize(small, (512, 512), interpolation=cv2.INTER_CUBIC))
    ]
    again = cv2.resize(slopes[1], (256, 256), interpolation=cv2.INTER_AREA)
    inner = np.s_[8:-8, 8:-8]
    assert np.abs(again - slopes[0])[inner].max() < 0.05 * np.abs(slopes[0]).max()


def test_details_of_a_texture_that_repeats_do_so_too() -> None:
    tile = np.random.default_rng(1).random((24, 24, 3)).astype(np.float32)
    alone = slopes_of(tile, np.ones((24, 24), bool), "both")
    rolled = slopes_of(np.roll(tile, (7, 5), (0, 1)), np.ones((24, 24), bool), "both")
    assert np.abs(np.roll(alone, (7, 5), (0, 1)) - rolled).max() < 1e-3


@pytest.mark.parametrize("scale", [1, 2, 4])
def test_each_art_pixel_has_one_of_few_normals(scale: int) -> None:
    form = ball(SIDE * scale)
    if scale > 1:  # the sprite's own steps
        steps = np.kron(ball(SIDE).mask, np.ones((scale, scale), bool))
        form = replace(form, mask=steps, alpha=steps.astype(np.float32))
    picture = sprite(form, scale)
    assert art_pixel(picture) == scale
    found = Sprite(detail=0.5, pixel_art=True)(form, picture)
    blocks = found.extended.reshape(SIDE, scale, SIDE, scale, 3)
    assert (blocks == blocks[:, :1, :, :1]).all()
    kinds = np.unique(found.extended.reshape(-1, 3), axis=0)
    assert 8 < len(kinds) <= len(DIRECTIONS)
    rim = form.mask & (cv2.erode(form.mask.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=0) == 0)
    assert (found.extended[rim] == DIRECTIONS[0]).all()  # the outline takes no light from any side
    assert set(np.unique(found.alpha)) == {0, 1}
    # Without details a direction is the nearest to the form: at most half the way between two.
    plain = Sprite(pixel_art=True)(form, replace(picture, colour=np.full_like(picture.colour, 0.7)))
    if scale == 1:
        assert angles(plain.extended, form.extended)[form.mask].max() < 23


def test_a_smooth_drawing_has_no_larger_art_pixels() -> None:
    y, x = np.mgrid[:200, :200]
    disc = np.clip(60 - np.hypot(x - 100, y - 90), 0, 1).astype(np.float32)
    assert art_pixel(Picture(np.repeat(disc[..., None], 3, -1), None)) == 1
    square = np.zeros((64, 64, 3), np.float32)
    square[16:48, 16:48] = 1  # fits any grid of up to 16 pixels, and tells none
    assert art_pixel(Picture(square, None)) == 1


def test_a_jpeg_and_a_shifted_grid_have_their_art_pixels() -> None:
    art = np.random.default_rng(2).integers(0, 256, (20, 20, 3)).astype(np.uint8)
    large = np.kron(art, np.ones((6, 6, 1), np.uint8))[2:, 4:]
    noisy = np.clip(large + np.random.default_rng(3).integers(-3, 4, large.shape), 0, 255)
    assert art_pixel(Picture(np.asarray(noisy / 255, np.float32), None)) == 6


def test_solid_dark_parts_are_no_outline() -> None:
    colour = np.full((20, 20, 3), 0.8, np.float32)
    colour[2:10, 2:10] = 0.05  # a black shoe
    colour[14, 2:18] = 0.05  # a line
    found = outlines(colour, np.ones((20, 20), bool))
    assert found[14, 2:18].all()
    assert found.sum() == 16


def test_each_sprite_of_a_sheet_is_alone_and_turned_ones_are_upright() -> None:
    form = ball()
    picture = sprite(form)
    alone = Sprite(detail=1)(form, picture)
    cells = (Cell("a", 0, 0, SIDE, SIDE), Cell("b", SIDE, 0, SIDE, SIDE, turned=1))

    def sheet(one: Floats) -> Floats:
        return np.concatenate([one, np.rot90(one, -1)], axis=1)

    assert picture.alpha is not None
    both = NormalMap(
        *(
            sheet(form.extended),
            sheet(form.mask.astype(np.float32)) > 0,
            sheet(form.alpha),
            form.seen,
            None,
            (),
        ),
        cells=cells,
    )
    found = Sprite(detail=1)(both, Picture(sheet(picture.colour), sheet(picture.alpha)))
    assert np.allclose(found.extended, sheet(alone.extended), atol=1e-5)


def test_each_sprite_of_a_sheet_is_given_the_form_by_itself() -> None:
    ball_, coin = ball(64), Sprite(form=Form("flat", 0.2, 1.0))
    small = Picture(np.ones((64, 64, 3), np.float32), None)
    alone = coin(ball_, small)
    assert np.allclose(alone.extended[32, 32], [0, 0, 1], atol=1e-3)
    assert angles(alone.extended, ball_.extended)[ball_.mask].mean() > 15

    both = replace(
        ball_,
        extended=np.concatenate([ball_.extended] * 2, axis=1),
        mask=np.concatenate([ball_.mask] * 2, axis=1),
        alpha=np.concatenate([ball_.alpha] * 2, axis=1),
        cells=tuple(Cell(f"{left}", left, 0, 64, 64) for left in (0, 64)),
    )
    found = coin(both, Picture(np.ones((64, 128, 3), np.float32), None))
    assert np.allclose(found.extended, np.concatenate([alone.extended] * 2, axis=1), atol=1e-6)


def test_the_options_reach_the_map(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    form = ball(96)
    form = replace(form, mask=np.kron(ball().mask, np.ones((3, 3), bool)))
    picture = sprite(form, 3)
    assert picture.alpha is not None
    Image.fromarray(np.rint(255 * np.dstack([picture.colour, picture.alpha])).astype(np.uint8)).save(
        "orc.png"
    )
    Image.open("orc.png").save(
        "orcs.webp", save_all=True, append_images=[ImageOps.mirror(Image.open("orc.png"))], lossless=True
    )

    def generate(*more: str) -> int:
        return main(["generate", "--model", "model.onnx", *more])

    asked: dict[str, list[str]] = {
        "form": [],
        "detail": ["--detail", "0.8"],
        "art": ["--pixel-art"],
        "flat": ["--form", "flat"],
    }
    for name, options in asked.items():
        assert generate("orc.png", "-o", name, *options) == 0
    maps = {name: read_png(f"{name}/orc_normal.png")[0] for name in asked}
    assert angles(maps["form"], maps["detail"])[form.mask].mean() > 5
    assert angles(maps["form"], maps["flat"])[form.mask].mean() > 5
    blocks = maps["art"].reshape(32, 3, 32, 3, 3)
    assert np.abs(blocks - blocks[:, :1, :, :1]).max() < 1e-6
    assert generate("orc.png", "-o", "sheet", "--pixel-art", "--sheet", "1x1") == 0
    assert np.array_equal(read_png("sheet/orc_normal.png")[0], maps["art"])
    assert generate("orcs.webp", "-o", "moving", "--pixel-art", "--bits", "16", "--frame", "own") == 0
    blocks = read_png("moving/orcs_0002_normal.png")[0].reshape(32, 3, 32, 3, 3)
    assert np.abs(blocks - blocks[:, :1, :, :1]).max() < 1e-6
    capsys.readouterr()
    for options, sentence in (
        (["--detail", "1.5"], "detail"),
        (["--detail", "much"], "detail"),
        (["--form", "square"], "form is 'square'; give round, flat or hollow"),
        (["--form", "flat", "--tileset", "16x16"], "--form needs an object with an edge"),
        (["--form", "flat", "--hints", "h.json"], "--form overrides hints; use only one of the two"),
        (
            ["--pixel-art", "--size", "64"],
            "--pixel-art keeps the drawing's own pixels, and therefore its size",
        ),
    ):
        assert generate("orc.png", "-o", "bad", *options) == 2
        said = capsys.readouterr().err
        assert sentence in said
        assert len(said.splitlines()) == 1
    assert not Path("bad").exists()


@pytest.mark.slow
def test_enlarged_pixel_art_has_the_map_of_the_art_itself(here: Path) -> None:
    painted = sprite(ball())
    assert painted.alpha is not None
    small = np.rint(255 * np.dstack([painted.colour, painted.alpha])).astype(np.uint8)
    once = np.ones((4, 4, 1), np.uint8)
    Image.fromarray(small).save("one.png")
    Image.fromarray(np.kron(small, once)).save("four.png")
    Image.fromarray(np.kron(np.hstack([small, small]), once)).save("row.png")
    for names in (["one.png", "four.png"], ["row.png", "--sheet", "2x1"]):
        arguments = "--pixel-art", "--alpha", "--pad", "0"
        assert main(["generate", *names, *arguments]) == 0  # at the shipped model's size, larger than both
    one, four, row = (np.asarray(Image.open(f"normals/{name}_normal.png")) for name in ("one", "four", "row"))
    assert np.array_equal(four, np.kron(one, once))
    assert np.array_equal(row, np.hstack([four, four]))
    assert np.array_equal(four[..., 3] > 0, np.kron(small, once)[..., 3] > 0)
