"""Sheets: a map of a sheet is what its cells' maps are, cut out by hand; on real files."""

import json
import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from normal_pngs import read_png
from normalgan.__main__ import main
from normalgan.decoding import Decoded
from normalgan.inference.cleaning.silhouette import is_silhouette
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.series import Member
from normalgan.inference.composites.sheets import drawings_in
from normalgan.inference.normal_map import NormalMap, as_it_lies
from normalgan.inference.reading.picture import Picture, to_picture
from pens import blob, outline, overlap

Pixels = NDArray[np.uint8]
SPRITES = [blob((96, 96), (50 + 3 * i, 52), 24 + 2 * i) for i in range(6)]


def pen(filled: NDArray[np.float32]) -> Pixels:
    """A drawing in lines on white paper, (H, W)."""
    return np.rint(255 * (1 - outline(filled))).astype(np.uint8)


def sprite(filled: NDArray[np.float32], number: int = 0) -> Pixels:
    """A coloured drawing on nothing, (H, W, 4)."""
    colour = np.array([90 + 20 * number, 160, 200 - 20 * number])
    predicted = colour * (1 - outline(filled))[..., None]
    return np.dstack([predicted, 255 * (filled > 0.5)]).astype(np.uint8)


def painted(alpha: NDArray[np.float32]) -> Picture:
    """A dark picture on nothing."""
    return Picture(np.full((*alpha.shape, 3), 0.2, np.float32), alpha)


def sheet_of(cells: list[Pixels], columns: int = 3) -> Pixels:
    return np.vstack([np.hstack(cells[i : i + columns]) for i in range(0, len(cells), columns)])


def generate(*arguments: str) -> int:
    return main(["generate", *arguments, "--model", "model.onnx"])


def pixels(path: str) -> Pixels:
    return np.asarray(Image.open(path))


def test_a_hole_is_cut_in_the_drawing_of_a_sheet_where_a_point_says(
    here: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    Image.fromarray(sheet_of([pen(each) for each in SPRITES])).save("sheet.png")
    for way in (("--sheet", "3x2"), ("--split", "auto")):
        assert generate("sheet.png", "--alpha", "--hole", "146,52", *way) == 0
        mask = pixels("normals/sheet_normal.png")[..., 3]
        assert mask[52, [50, 146, 242]].tolist() == [255, 0, 255]
    capfd.readouterr()
    assert generate("sheet.png", "--hole", "98,2", "--sheet", "3x2") == 2
    assert "sheet.png: no enclosed region lies at x 98, y 2; give a point" in capfd.readouterr().err
    assert generate("sheet.png", "--hole", "2,2", "--split", "auto") == 2
    assert "no drawing of the sheet lies at x 2, y 2; give a point" in capfd.readouterr().err


@pytest.mark.parametrize("kind", ["lines", "sprites"])
def test_a_sheet_is_painted_as_its_cells_cut_by_hand(here: Path, kind: str) -> None:
    cells = [pen(each) if kind == "lines" else sprite(each, i) for i, each in enumerate(SPRITES)]
    blank = np.full_like(cells[0], 255 if kind == "lines" else 0)
    cells[4] = blank
    Image.fromarray(sheet_of(cells)).save("sheet.png")
    assert generate("sheet.png", "--sheet", "3x2", "--alpha", "--pad", "0") == 0
    whole = pixels("normals/sheet_normal.png")
    for i, cell in enumerate(cells):
        part = whole[i // 3 * 96 : i // 3 * 96 + 96, i % 3 * 96 : i % 3 * 96 + 96]
        if i == 4:
            assert (part == (128, 128, 255, 0)).all()
            continue
        Image.fromarray(cell).save(f"cell{i}.png")
        assert generate(f"cell{i}.png", "--alpha", "--pad", "0") == 0
        assert np.array_equal(part, pixels(f"normals/cell{i}_normal.png")), i


def test_four_sprites_in_a_row_keep_their_opacity_as_mask() -> None:
    row = np.hstack(SPRITES[:4])
    assert is_silhouette(painted(row))
    assert is_silhouette(painted(np.vstack([row, row, row])))
    lines = np.hstack([outline(each) for each in SPRITES[:4]])
    assert not is_silhouette(painted(lines))
    dashes = np.zeros((200, 200), np.float32)
    for angle in np.linspace(0, 2 * np.pi, 24, endpoint=False):
        centre = np.array([100 + 80 * np.cos(angle), 100 + 80 * np.sin(angle)])
        along = 7 * np.array([-np.sin(angle), np.cos(angle)])
        ends = np.rint([centre - along, centre + along]).astype(int).tolist()
        cv2.line(dashes, ends[0], ends[1], 1, 3)
    assert not is_silhouette(painted(dashes))


@pytest.mark.parametrize("how", [(), ("--split", "auto"), ("--sheet", "3x1")])
def test_a_box_that_fills_its_cell_is_an_object_and_no_paper(here: Path, how: tuple[str, ...]) -> None:
    sheet = np.zeros((64, 192, 4), np.uint8)
    sheet[:, :192] = sheet_of([sprite(blob((64, 64), (32, 32), 24))] * 3)
    sheet[4:60, 72:120] = 150, 100, 60, 255  # a flat crate, which fills its part of an uncut sheet
    sheet[:, 128:] = 150, 100, 60, 255  # and one that fills its cell
    Image.fromarray(sheet).save("crates.png")
    assert generate("crates.png", *how, "--alpha", "--pad", "0") == 0
    assert np.array_equal(pixels("normals/crates_normal.png")[..., 3], sheet[..., 3])


def test_a_card_that_lines_are_drawn_on_is_no_object() -> None:
    alpha = np.pad(np.ones((160, 200), np.float32), 20)
    lines = np.pad(outline(blob((160, 200), (80, 90), 40)), 20)
    for paper in (1.0, 0.85):
        card = Picture(np.repeat((paper * (1 - lines))[..., None], 3, 2).astype(np.float32), alpha)
        assert not is_silhouette(card)
    assert is_silhouette(Picture(np.full((200, 240, 3), 0.5, np.float32), alpha))


def test_islands_are_found_whatever_their_places(here: Path) -> None:
    """Sprites packed without a grid, one with an eye of its own apart from it, one in the bend of another."""
    sheet = np.zeros((260, 320, 4), np.uint8)
    places = [(0, 0), (4, 100), (110, 40), (150, 200)]
    for i, (top, left) in enumerate(places):
        sheet[top : top + 96, left : left + 96] = np.maximum(
            sheet[top : top + 96, left : left + 96], sprite(SPRITES[i], i)
        )
    Image.fromarray(sheet).save("packed.png")
    assert generate("packed.png", "--split", "auto", "--alpha") == 0
    whole = pixels("normals/packed_normal.png")
    assert overlap(whole[..., 3] > 127, sheet[..., 3] > 127) > 0.98
    for i, (top, left) in enumerate(places):
        rows, columns = (np.flatnonzero((SPRITES[i] > 0.5).any(axis)) for axis in (1, 0))
        box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        Image.fromarray(sprite(SPRITES[i], i)[box]).save("one.png")
        assert generate("one.png", "--alpha") == 0
        part = whole[top : top + 96, left : left + 96][box]
        there = SPRITES[i][box] > 0.5
        assert np.array_equal(part[there], pixels("normals/one_normal.png")[there]), i


def test_drawings_in_pen_are_told_apart_by_the_paper_between_them(here: Path) -> None:
    sheet = np.full((230, 330), 255, np.uint8)
    for i, (top, left) in enumerate([(5, 5), (20, 120), (120, 10), (110, 220)]):
        part = sheet[top : top + 96, left : left + 96]
        part[:] = np.minimum(part, pen(SPRITES[i]))
    Image.fromarray(sheet).save("page.png")
    assert generate("page.png", "--split", "auto", "--alpha") == 0
    truth = np.zeros(sheet.shape, bool)
    for i, (top, left) in enumerate([(5, 5), (20, 120), (120, 10), (110, 220)]):
        truth[top : top + 96, left : left + 96] |= np.maximum(SPRITES[i], outline(SPRITES[i]) > 0.5) > 0.5
    assert overlap(pixels("normals/page_normal.png")[..., 3] > 127, truth) > 0.94


def atlas(*, rotated: bool = True, array: bool = False, size: tuple[int, int] = (200, 200)) -> dict[str, Any]:
    """An atlas of three sprites; the second lies turned clockwise in the sheet."""
    entries = {
        "a": {"frame": {"x": 0, "y": 0, "w": 96, "h": 96}, "rotated": False, "trimmed": False},
        "b": {"frame": {"x": 100, "y": 0, "w": 96, "h": 80}, "rotated": rotated, "trimmed": True},
        "c": {"frame": {"x": 4, "y": 102, "w": 96, "h": 96}, "rotated": False, "duration": 100},
        "again": {"frame": {"x": 4, "y": 102, "w": 96, "h": 96}, "rotated": False},
    }
    frames: Any = [{"filename": name, **each} for name, each in entries.items()] if array else entries
    return {"frames": frames, "meta": {"image": "sheet.png", "size": {"w": size[0], "h": size[1]}}}


def packed() -> Pixels:
    sheet = np.zeros((200, 200, 4), np.uint8)
    sheet[:96, :96] = sprite(SPRITES[0])
    sheet[:96, 100:180] = np.rot90(sprite(SPRITES[1], 1)[8:88], -1)
    sheet[102:198, 4:100] = sprite(SPRITES[2], 2)
    return sheet


def textures(*names: str) -> dict[str, Any]:
    """An atlas of several sheets, as Phaser reads it; the last one is that of `atlas`."""
    others = [{"image": name, "size": {"w": 64, "h": 64}, "frames": []} for name in names[:-1]]
    told = atlas(array=True)
    last = {"image": names[-1], "size": told["meta"]["size"], "frames": told["frames"]}
    return {"textures": [*others, last]}


@pytest.mark.parametrize("told", [atlas(), atlas(array=True), textures("other.png", "sheet.png")])
def test_an_atlas_says_where_sprites_lie_and_which_are_turned(here: Path, told: dict[str, Any]) -> None:
    Image.fromarray(packed()).save("sheet.png")
    Path("sheet.json").write_text(json.dumps(told))
    assert generate("sheet.png", "--atlas", "sheet.json", "--alpha", "--pad", "0") == 0
    whole = pixels("normals/sheet_normal.png")
    for name, cell, part in (
        ("a", sprite(SPRITES[0]), whole[:96, :96]),
        ("b", sprite(SPRITES[1], 1)[8:88], np.rot90(whole[:96, 100:180])),
        ("c", sprite(SPRITES[2], 2), whole[102:198, 4:100]),
    ):
        Image.fromarray(cell).save(f"{name}.png")
        assert generate(f"{name}.png", "--alpha", "--pad", "0") == 0
        assert np.array_equal(part, pixels(f"normals/{name}_normal.png")), name
    assert generate("sheet.png", "--atlas", ".", "-o", "by_folder", "--alpha", "--pad", "0") == 0
    assert np.array_equal(pixels("by_folder/sheet_normal.png"), whole)


def test_heights_and_shading_of_a_sheet_are_those_of_its_sprites(here: Path) -> None:
    """A turned sprite has its normals as it stands: its surface is that of the upright one, turned."""
    Image.fromarray(packed()).save("sheet.png")
    Path("sheet.json").write_text(json.dumps(atlas()))
    extras = ("--height", "tiff", "--ao", "--curvature", "--specular")
    assert generate("sheet.png", "--atlas", "sheet.json", *extras) == 0
    for name, cell, box in (
        ("a", sprite(SPRITES[0]), np.s_[:96, :96]),
        ("b", sprite(SPRITES[1], 1)[8:88], np.s_[:96, 100:180]),
    ):
        Image.fromarray(cell).save(f"{name}.png")
        assert generate(f"{name}.png", *extras) == 0
        on = cell[..., 3] > 0
        for kind in ("height.tiff", "ao.png", "curvature.png", "specular.png"):
            part = np.asarray(cv2.imread(f"normals/sheet_{kind}", cv2.IMREAD_UNCHANGED))[box]
            alone = np.asarray(cv2.imread(f"normals/{name}_{kind}", cv2.IMREAD_UNCHANGED))
            part = np.rot90(part) if name == "b" else part
            assert np.allclose(part[on], alone[on], atol=1e-3), (name, kind)
    whole = pixels("normals/sheet_ao.png"), pixels("normals/sheet_curvature.png")
    assert [int(each[98, 150]) for each in whole] == [255, 128]  # between the sprites


def test_masks_and_hints_are_those_of_the_sheet(here: Path) -> None:
    Image.fromarray(sheet_of([pen(each) for each in SPRITES])).save("sheet.png")
    mask = np.zeros((192, 288), np.uint8)
    mask[120:170, 120:170] = 255
    Image.fromarray(mask).save("mask.png")
    Path("hints.json").write_text(json.dumps([{"x": 140, "y": 140, "normal": [-0.8, 0.0, 0.6]}]))
    asked = ("--mask", "mask.png", "--hints", "hints.json", "--alpha")
    assert generate("sheet.png", "--sheet", "3x2", *asked) == 0
    normals, alpha = read_png("normals/sheet_normal.png")
    assert overlap(alpha > 0.5, mask > 127) > 0.97
    assert normals[140, 140, 0] < -0.6


def test_cells_can_share_a_frame(here: Path) -> None:
    """A small drawing is enlarged by itself, but not beside large ones in the same square."""
    cells = [pen(blob((96, 96), (48, 52), 30)), pen(blob((96, 96), (48, 52), 10))]
    Image.fromarray(np.hstack(cells)).save("sheet.png")
    spans = {}
    for frame in ("own", "shared"):
        assert generate("sheet.png", "--sheet", "2x1", "--frame", frame, "-o", frame) == 0
        small = read_png(f"{frame}/sheet_normal.png")[0][:, 96:, 0]
        spans[frame] = float(np.ptp(small))
    assert spans["own"] > 0.8  # of the ramp's 1.06 within the margins
    assert 0.2 < spans["shared"] < 0.5


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (
            ["--sheet", "5x2"],
            "sheet.png is 288 × 192 pixels, which 5 columns and 2 rows do not divide evenly.",
        ),
        (["--sheet", "four"], "sheet is 'four'; give columns x rows, such as 4x3"),
        (["--sheet", "0x3"], "sheet is '0x3'; give columns x rows"),
        (["--sheet", "96x2"], "the cells of sheet.png would be 3 × 96 pixels"),
        (
            ["--sheet", "3x2", "--split", "auto"],
            "--sheet and --split each give the positions of the drawings",
        ),
        (["--sheet", "3x2", "--size", "64"], "a sheet of pixels keeps its layout"),
        (["--split", "by hand"], "expected"),
        (["--atlas", "none.json"], "there is no atlas none.json"),
        (["--atlas", "empty"], "empty has no atlas for sheet.png; its name must be sheet.json"),
        (["--atlas", "other.json"], "is for a sheet of 200 × 200 pixels, but sheet.png has 288 × 192."),
        (
            ["--atlas", "outside.json"],
            "the sprite 'a' at x 280, y 0 with 96 × 96 pixels lies outside of sheet.png",
        ),
        (["--atlas", "placeless.json"], "the sprite 'a' has no position; it needs x, y, width and height"),
        (["--atlas", "broken.json"], "the atlas broken.json is broken JSON: line 1, column 2"),
        (["--atlas", "nothing.json"], "lists 0 sprites for sheet.png; it needs 1 to 4096"),
        (
            ["--atlas", "style.json"],
            "style.json looks like a CSS style sheet; supported atlas formats are JSON",
        ),
        (["--atlas", "strange.json"], "has the sprites of a.png, b.png; none of these is sheet.png."),
        (["--sheet", "1x1", "--mask", "outline", "--hints", "far.json"], "far.json"),
    ],
)
def test_what_cannot_be_used_is_told_in_a_sentence(
    here: Path, arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Image.fromarray(sheet_of([pen(each) for each in SPRITES])).save("sheet.png")
    Path("empty").mkdir()
    outside = {"frames": {"a": {"frame": {"x": 280, "y": 0, "w": 96, "h": 96}}}}
    for name, told in (
        ("other", json.dumps(atlas())),
        ("outside", json.dumps(outside)),
        ("placeless", json.dumps({"frames": {"a": {"frame": {"x": "1"}}}})),
        ("broken", "{"),
        ("nothing", "[]"),
        ("style", ".fox { width: 20px }"),
        ("strange", json.dumps(textures("a.png", "b.png"))),
        ("far", json.dumps([{"x": 999, "y": 0, "normal": [0, 0, 1]}])),
    ):
        Path(f"{name}.json").write_text(told)
    assert generate("sheet.png", *arguments) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert len(said.splitlines()) == 1
    assert not Path("normals").exists()


def test_a_cell_that_cannot_be_painted_is_named_and_the_others_are(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    grain = np.full((96, 96), 255, np.uint8)
    grain[40, 40] = 250
    Image.fromarray(np.hstack([pen(SPRITES[0]), grain])).save("sheet.png")
    assert generate("sheet.png", "--sheet", "2x1", "--alpha") == 1
    assert "row 1, column 2: it is left flat, because no lines were found in it" in capsys.readouterr().err
    assert pixels("normals/sheet_normal.png")[:, 96:, 3].max() == 0


def test_a_tiny_sprite_of_an_atlas_is_named(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sheet = packed()
    sheet[40:47, 186:192] = (90, 60, 30, 255)
    Image.fromarray(sheet).save("sheet.png")
    told = atlas()
    told["frames"]["spark"] = {"frame": {"x": 186, "y": 40, "w": 6, "h": 7}}
    told["frames"]["nothing"] = {"frame": {"x": 190, "y": 190, "w": 1, "h": 1}}
    Path("sheet.json").write_text(json.dumps(told))
    assert generate("sheet.png", "--atlas", "sheet.json") == 1
    said = capsys.readouterr().err
    assert "spark: it is left flat, because it is 6 × 7 pixels; a drawing needs at least 8 a side" in said
    assert "nothing" not in said
    told["frames"] = {name: told["frames"][name] for name in ("spark", "nothing")}
    Path("sheet.json").write_text(json.dumps(told))
    assert generate("sheet.png", "--atlas", "sheet.json") == 2
    assert "spark: it is 6 × 7 pixels; a drawing needs at least 8 a side." in capsys.readouterr().err


def test_atlases_lie_in_folders_as_their_sheets_do(here: Path) -> None:
    for folder, row in (("in", 0), ("in/deep", 1)):
        Path(folder).mkdir()
        sheet = np.full((192, 96), 255, np.uint8)
        sheet[96 * row : 96 * row + 96] = pen(SPRITES[row])
        Image.fromarray(sheet).save(f"{folder}/sheet.png")
        frame = {"frame": {"x": 0, "y": 96 * row, "w": 96, "h": 96}}
        Path(f"{folder}/sheet.json").write_text(json.dumps({"frames": {"one": frame}}))
    assert generate("in", "--recursive", "--atlas", "in", "--alpha") == 0
    assert pixels("normals/sheet_normal.png")[:96, :, 3].any()
    assert pixels("normals/deep/sheet_normal.png")[96:, :, 3].any()


def test_the_drawings_of_a_sheet_are_pixel_art_if_the_sheet_is() -> None:
    sheet = np.full((16, 32, 3), 255, np.uint8)
    sheet[4:8, [4, 20]] = 0
    decoded = Decoded(sheet, (16, 32))
    cells = Cell("left", 0, 0, 16, 16), Cell("right", 16, 0, 16, 16)
    found = drawings_in(decoded, cells, Member(to_picture(decoded), pixel_art=True))
    assert [member.pixel_art for _, member in found] == [True, True]


def test_a_turned_sprite_is_lit_as_it_lies() -> None:
    normals = np.tile(np.array([0.6, 0, 0.8], np.float32), (8, 16, 1))
    there, seen = np.ones((8, 16), np.bool_), np.zeros((8, 8), np.float32)
    cells = Cell("upright", 0, 0, 8, 8), Cell("turned", 8, 0, 8, 8, turned=True)
    sheet = NormalMap(normals, there, there.astype(np.float32), seen, None, (), cells=cells)
    assert as_it_lies(sheet)[0, 0].tolist() == pytest.approx([0.6, 0, 0.8])
    assert as_it_lies(sheet)[0, 8].tolist() == pytest.approx([0, -0.6, 0.8])  # what looked right looks down
    assert sheet.extended[0, 8].tolist() == pytest.approx([0.6, 0, 0.8])


@pytest.mark.parametrize("columns", [2, 9])
def test_a_sheet_of_sprites_that_nobody_says_is_one_is_split(
    here: Path, capsys: pytest.CaptureFixture[str], columns: int
) -> None:
    cells = [sprite(SPRITES[i % 6], i % 6) for i in range(2 * columns)]
    small = [np.asarray(cv2.resize(e, (40, 40), interpolation=cv2.INTER_AREA), np.uint8) for e in cells]
    Image.fromarray(sheet_of(small, columns)).save("sheet.png")
    assert generate("sheet.png", "--alpha") == 0
    assert f"sheet.png: it shows {2 * columns} separate figures" in capsys.readouterr().err
    found = pixels("normals/sheet_normal.png")
    assert overlap(found[..., 3] > 127, sheet_of(small, columns)[..., 3] > 127) > 0.97
    assert generate("sheet.png", "--split", "auto", "--alpha", "-o", "split") == 0
    assert np.array_equal(found, pixels("split/sheet_normal.png"))


@pytest.mark.parametrize("side", [48, 64, 96])
def test_small_figures_on_white_are_found_as_on_their_page(here: Path, side: int) -> None:
    ghost, solid = np.full((4 * side, 4 * side), 255, np.uint8), np.zeros((4 * side, 4 * side), np.uint8)
    dome = [(2 + np.cos(a) * 1.5, 1.9 - np.sin(a) * 1.5) for a in np.linspace(0, np.pi, 40)]
    hem = [(0.5 + 0.375 * i, 3.6 - 0.3 * (i % 2)) for i in range(9)]
    path = np.rint(np.array([*dome, *hem]) * side).astype(np.int32)
    cv2.fillPoly(solid, [path], 255)
    cv2.polylines(solid, [path], True, 255, 8)
    cv2.polylines(ghost, [path], True, 30, 8, cv2.LINE_AA)
    for x in (1.5, 2.5):
        cv2.circle(ghost, (round(x * side), round(1.7 * side)), side // 5, 30, -1, cv2.LINE_AA)
    small, wanted = (cv2.resize(e, (side, side), interpolation=cv2.INTER_AREA) for e in (ghost, solid))
    Image.fromarray(np.hstack([small, small])).save("pair.png")
    assert generate("pair.png", "--alpha", "--pad", "0") == 0
    assert overlap(pixels("normals/pair_normal.png")[..., 3] > 127, np.hstack([wanted, wanted]) > 127) > 0.96


def test_a_warning_about_a_figure_says_where_it_is_on_the_page(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = np.full((240, 520), 255, np.uint8)
    for x in (120, 400):
        cv2.circle(page, (x, 120), 80, 0, 3, cv2.LINE_AA)
    page[165:, 370:430] = 255
    Image.fromarray(page).save("page.png")
    for size in ((), ("--size", "1040")):
        assert generate("page.png", *size) == 0
        said = capsys.readouterr().err
        place = re.search(r"figure 2: no line bounds the object near x (\d+), y (\d+)", said)
        assert place
        assert 320 < int(place[1]) < 480


def test_dashes_on_nothing_are_no_sprites() -> None:
    alpha = np.zeros((200, 200), np.float32)
    for angle in np.arange(0, 6.28, 0.2):
        start, end = ((100 + 80 * np.cos(angle + k), 100 + 80 * np.sin(angle + k)) for k in (0, 0.1))
        cv2.line(alpha, tuple(map(int, start)), tuple(map(int, end)), 1, 2)
    assert not is_silhouette(painted(alpha))


def test_a_sprite_that_libgdx_turned_counterclockwise_is_predicted_upright(here: Path) -> None:
    sheet = np.zeros((100, 100, 4), np.uint8)
    cell = sprite(SPRITES[1], 1)[8:88]
    sheet[:96, :80] = np.rot90(cell)
    Image.fromarray(sheet).save("sheet.png")
    Path("sheet.atlas").write_text("sheet.png\nsize: 100,100\nfox\n  bounds: 0,0,96,80\n  rotate: true\n")
    assert generate("sheet.png", "--atlas", ".", "--alpha", "--pad", "0") == 0
    Image.fromarray(cell).save("fox.png")
    assert generate("fox.png", "--alpha", "--pad", "0") == 0
    part = np.rot90(pixels("normals/sheet_normal.png")[:96, :80], -1)
    assert np.array_equal(part, pixels("normals/fox_normal.png"))


def test_sprites_whose_boxes_overlap_keep_their_pixels(here: Path) -> None:
    """The empty corner of a later box does not erase the sprite before it."""
    sheet = np.zeros((96, 150, 4), np.uint8)
    sheet[:, :96] = sprite(SPRITES[0])
    small = sprite(blob((96, 96), (66, 80), 12), 3)
    sheet[:, 54:] = np.where(small[..., 3:] > 0, small, sheet[:, 54:])
    Image.fromarray(sheet).save("sheet.png")
    frames = {"a": {"x": 0, "y": 0, "w": 96, "h": 96}, "b": {"x": 54, "y": 0, "w": 96, "h": 96}}
    Path("sheet.json").write_text(
        json.dumps({"frames": {key: {"frame": box} for key, box in frames.items()}})
    )
    assert generate("sheet.png", "--atlas", "sheet.json", "--alpha") == 0
    assert np.array_equal(pixels("normals/sheet_normal.png")[..., 3] > 0, sheet[..., 3] > 0)


@pytest.mark.parametrize("size", [(), ("--size", "400")])
def test_an_svg_sheet_is_cut_in_its_own_units(here: Path, size: tuple[str, ...]) -> None:
    circle = '<circle cx="50" cy="50" r="40" fill="none" stroke="#000" stroke-width="3"/>'
    svg = '<svg xmlns="http://www.w3.org/2000/svg" width="200" height="100" viewBox="{} 0 {} 100">{}</svg>'
    Path("sheet.svg").write_text(svg.format(0, 200, circle))
    frames = {"a": {"x": 0, "y": 0, "w": 100, "h": 100}, "b": {"x": 100, "y": 0, "w": 100, "h": 100}}
    Path("sheet.json").write_text(
        json.dumps({"frames": {key: {"frame": box} for key, box in frames.items()}})
    )
    assert generate("sheet.svg", "--atlas", "sheet.json", "--alpha", *size) == 0
    longest = 400 if size else 1024
    found = pixels("normals/sheet_normal.png")
    assert found.shape == (longest // 2, longest, 4)
    rows, columns = np.nonzero(found[..., 3] > 127)
    scale = longest / 200
    assert [columns.min(), columns.max()] == pytest.approx([8.5 * scale, 91.5 * scale], abs=scale)
    assert [rows.min(), rows.max()] == pytest.approx([8.5 * scale, 91.5 * scale], abs=scale)
