from pathlib import Path
from xml.etree import ElementTree as ET

import cv2
import numpy as np
import pytest

from normal_pngs import read_png
from normalgan.__main__ import main

HORSE = ("sketch", "horse-3", "--size", "96")


@pytest.fixture
def sphere(tmp_path: Path) -> str:
    import trimesh

    path = tmp_path / "ball.ply"
    trimesh.creation.icosphere(subdivisions=4).export(path)
    return str(path)


def ink(path: Path) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    picture = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert picture is not None
    assert picture.ndim == 2
    return 1 - picture / 255


def test_a_sphere_is_drawn_as_a_circle_in_the_middle(sphere: str, tmp_path: Path) -> None:
    out = tmp_path / "new" / "ball.png"
    assert main(["sketch", sphere, "-o", str(out), "--size", "128", "--margin", "0.125"]) == 0
    rows, columns = np.nonzero(ink(out) > 0.3)
    radius = np.hypot(rows + 0.5 - 64, columns + 0.5 - 64)
    assert len(radius) > 200
    assert radius.min() > 48 - 1.5
    assert radius.max() < 48 + 1.5


@pytest.mark.slow
def test_svg_and_png_show_the_same_lines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    svg, png = tmp_path / "h.svg", tmp_path / "h.png"
    assert main([*HORSE, "-o", str(svg)]) == 0
    assert main([*HORSE, "-o", str(png)]) == 0
    assert capsys.readouterr().out.split() == [str(svg), str(png)]
    drawn = np.zeros((96 * 8, 96 * 8), np.uint8)
    for path in ET.parse(svg).getroot().iter("{http://www.w3.org/2000/svg}path"):
        data = path.get("d", "")
        points = np.array([[float(v) for v in pair.split()] for pair in data.strip("MZ").split("L")])
        width = max(round(8 * float(path.get("stroke-width", 0))), 1)
        cv2.polylines(drawn, [np.rint(8 * points).astype(np.int32)], data.endswith("Z"), 255, width)
    same = cv2.resize(drawn, (96, 96), interpolation=cv2.INTER_AREA) / 255
    assert ink(png).sum() > 100
    assert np.abs(same - ink(png)).mean() < 0.02


def test_the_normal_map_lies_under_the_lines(tmp_path: Path) -> None:
    png, normal = tmp_path / "h.png", tmp_path / "h_normal.png"
    assert main([*HORSE, "-o", str(png), "--normal", str(normal), "--hand.strength", "[1,1]"]) == 0
    vectors, _ = read_png(normal)
    on = np.abs(vectors[..., :2]).max(-1) > 0.02
    near = cv2.dilate(on.astype(np.uint8), np.ones((7, 7))) > 0
    assert on.mean() > 0.1
    assert ink(png)[~near].sum() < 0.1 * ink(png).sum()


@pytest.mark.slow
def test_the_seed_decides_what_the_hand_does(sphere: str, tmp_path: Path) -> None:
    def drawn(*more: str) -> bytes:
        out = tmp_path / "h.png"
        assert main(["sketch", sphere, "--size", "96", "-o", str(out), *more]) == 0
        return out.read_bytes()

    hand = ("--hand.strength", "[1,1]", "--medium.strength", "[1,1]")
    assert drawn(*hand) == drawn(*hand) != drawn(*hand, "--seed", "1")
    assert drawn() == drawn("--hand.strength", "[0,0]", "--medium.strength", "[0,0]")


def test_the_view_turns_the_object(tmp_path: Path) -> None:
    widths = []
    for azimuth in ("0", "90"):
        out = tmp_path / f"{azimuth}.png"
        assert main([*HORSE, "-o", str(out), "--azimuth", azimuth]) == 0
        widths.append(np.ptp(np.nonzero(ink(out) > 0.3)[1]))
    assert min(widths) < 0.7 * max(widths)  # a horse is longer than wide


def test_a_sheet_seen_edge_on_is_no_drawing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sheet, out = tmp_path / "sheet.obj", tmp_path / "sheet.svg"
    sheet.write_text("v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 2 3 4\n")
    view = ("sketch", str(sheet), "-o", str(out), "--size", "64", "--azimuth", "30", "--elevation")
    assert main([*view, "0"]) == 2
    assert f"finds no lines in {sheet} at azimuth 30 and elevation 0: there it" in capsys.readouterr().err
    assert not out.exists()
    assert main([*view, "40"]) == 0


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["hors"], "hors is neither a mesh file (.glb, .gltf, .obj, .off, .ply, .stl) nor an embedded"),
        (["hrose"], "Did you mean horse?"),
        (["none.obj"], "none.obj is not a file, a folder or a pattern"),
        (["horse", "-o", ""], "--output is empty; name a file"),
        (["horse", "-o", "a.jpg"], "the drawing a.jpg must be a .svg or a .png."),
        (["horse", "--normal", "n.tif"], "the normal map n.tif must be a .png."),
        (
            ["horse", "-o", "a.png", "--normal", "a.png"],
            "a.png would be written twice; give --normal another",
        ),
        (["horse", "--medium.noise", "0.1"], "a medium needs pixels; write sketch.svg as .png"),
        (["horse", "--size", "3"], "--size: 3 is out of range; it must be >= 8 and <= 8192."),
        (["horse", "--hand.strenth", "1"], "no setting 'strenth' in it. Did you mean strength?"),
        (["horse", "--lines", "Sugestive"], "no LineDrawing named 'Sugestive'. Did you mean Sug"),
        (["horse", "--hand.strength", "[2,3]"], "a setting cannot be used: strength of Hand is (2.0, 3.0)"),
        (["horse", "--widht", "3"], "there is no option --widht."),
        ([], "missing: mesh."),
    ],
)
def test_bad_input_is_one_sentence(
    arguments: list[str],
    sentence: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["sketch", *arguments]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert len(said.splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_a_folder_must_hold_one_mesh(sphere: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "out.svg")
    assert main(["sketch", str(tmp_path), "-o", out, "--size", "64"]) == 0
    Path(sphere).with_name("apple.ply").write_bytes(Path(sphere).read_bytes())
    assert main(["sketch", str(tmp_path), "-o", out, "--size", "64"]) == 2
    one = tmp_path / "apple.ply"
    assert f"{tmp_path} holds 2 meshes; name one, such as {one}." in capsys.readouterr().err


def test_only_gltf_has_clips(sphere: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sketch", sphere, "--clip", "walk"]) == 2
    assert f"{sphere} has no clips; give a rigged glTF file." in capsys.readouterr().err


def test_help_ends_well(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sketch", "--help"]) == 0
    assert "draw a mesh" in capsys.readouterr().out.lower()
