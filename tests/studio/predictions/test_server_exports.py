"""All files of a drawing at once, as programs want them; alpha, mask and ambient occlusion."""

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from starlette.testclient import TestClient
from studio_client import CENTRE, HEIGHT, RADIUS, WIDTH, asking, away, b64, circle, png, serving

from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs import Output
from normalgan.inference.outputs.occlusion import occlusion
from normalgan.studio.predictions.exports import ExportRequest


def exported(client: TestClient, **fields: Any) -> tuple[str, bytes]:
    answer = client.post("/api/export", json=asking(name="fox", **fields))
    assert answer.status_code == 200, answer.text
    return answer.headers["content-disposition"].rpartition("''")[2], answer.content


def unzipped(content: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        assert archive.testzip() is None
        return {name: archive.read(name) for name in archive.namelist()}


def pixels(content: bytes) -> NDArray[Any]:
    return np.asarray(Image.open(io.BytesIO(content)))


BESIDE = "fox_ao.png fox_curvature.png fox_specular.png fox_preview.png"


@pytest.mark.parametrize(
    ("preset", "names"),
    [
        ("plain", "fox_normal.png fox_line.png fox_mask.png fox_height.png " + BESIDE),
        (
            "unity",
            "fox_NormalMap.png fox_LineArt.png fox_Mask.png fox_Height.png "
            "fox_Occlusion.png fox_Curvature.png fox_Specular.png fox_Preview.png",
        ),
        (
            "unreal",
            "T_fox_N.png T_fox_L.png T_fox_M.png T_fox_H.png "
            "T_fox_AO.png T_fox_C.png T_fox_S.png T_fox_Preview.png",
        ),
        ("godot", "fox_n.png fox_line.png fox_mask.png fox_height.png " + BESIDE),
        ("godot3", "fox_n.png fox_line.png fox_mask.png fox_height.png " + BESIDE),
        ("blender", "fox_normal.png fox_line.png fox_mask.png fox_height.tiff " + BESIDE),
    ],
)
def test_all_files_come_as_the_program_wants_them(
    model: Path, tmp_path: Path, preset: str, names: str
) -> None:
    art = png(circle())
    with serving(model, tmp_path) as client:
        name, content = exported(client, what="all", format=preset, line_art=b64(art))
        assert exported(client, number=2, what="all", format=preset, line_art=b64(art))[1] == content
        up = pixels(exported(client, number=3, format="png8", alpha=True)[1])
    assert name == f"fox_{preset}.zip"
    files = unzipped(content)
    own = names.split(maxsplit=1)[0]  # beside it, what the program imports it by, as of generate --engine
    beside = {"plain": "", "unity": ".meta", "godot": ".import", "godot3": ".import"}.get(
        preset, ".import.py"
    )
    assert set(files) == {*names.split(), "README.txt", *([own + beside] if beside else [])}
    normal, line, mask, height, *shading, preview = (files[each] for each in names.split())
    assert line == art
    found = pixels(normal)
    assert found.shape == (HEIGHT, WIDTH, 4)
    assert normal[24] == (16 if preset == "blender" else 8)  # the bits in a PNG's head
    if preset in {"unreal", "godot3"}:
        green = np.where(up[..., 3] > 0, 255 - up[..., 1].astype(int), up[..., 1])
        assert np.abs(found[..., 1].astype(int) - green)[up[..., 3] > 0].max() <= 1
    elif preset != "blender":
        assert np.array_equal(found, up)
    assert np.array_equal(pixels(mask), up[..., 3])
    assert {pixels(each).shape for each in (height, *shading)} == {(HEIGHT, WIDTH)}
    assert len({each.tobytes() for each in map(pixels, shading)}) == len(shading) == 3
    assert pixels(preview).shape == (HEIGHT, WIDTH, 3)


@pytest.mark.parametrize(
    ("kind", "name"), [("ao", "ao"), ("curvature", "curvature"), ("specular", "specular")]
)
def test_one_of_the_shading_maps_is_that_of_all_files(
    model: Path, tmp_path: Path, kind: str, name: str
) -> None:
    with serving(model, tmp_path) as client:
        alone, content = exported(client, what=kind)
        _, whole = exported(client, number=2, what="all", format="plain")
    assert alone == f"fox_{name}.png"
    assert unzipped(whole)[alone] == content


def test_the_edge_of_the_alpha_is_smooth(model: Path, tmp_path: Path) -> None:
    with serving(model, tmp_path) as client:
        alpha = pixels(exported(client, what="mask")[1]).astype(float) / 255
    # As an edge that is drawn: where a circle's rim passes, a share of the pixel is covered.
    rim = np.abs(alpha - 0.5) < 0.45
    assert 0.5 * 2 * np.pi * RADIUS < rim.sum() < 3 * 2 * np.pi * RADIUS
    assert np.abs(away()[rim] - away()[rim].mean()).max() < 2
    assert len(np.unique(np.rint(255 * alpha[rim]))) > 15  # the outer edge alone takes the share of its ink
    assert alpha[int(CENTRE[1]), int(CENTRE[0])] == 1
    assert alpha[2, 2] == 0


def test_the_preview_among_all_files_is_the_one_under_the_users_lights(model: Path, tmp_path: Path) -> None:
    lit = png(np.full((HEIGHT, WIDTH, 4), 99, np.uint8))
    with serving(model, tmp_path) as client:
        files = unzipped(exported(client, what="all", format="unity", lit_picture=b64(lit))[1])
        refused = client.post("/api/export", json=asking(what="all", lit_picture=b64(b"no picture")))
    assert files["fox_Preview.png"] == lit
    assert refused.json()["error"] == "the lit picture is not a PNG."


@pytest.mark.parametrize(
    ("preset", "name"), [("plain", "fox_colour"), ("unity", "fox_Colour"), ("unreal", "T_fox_D")]
)
def test_all_files_have_the_drawing_in_colour(model: Path, tmp_path: Path, preset: str, name: str) -> None:
    colours = png(np.full((HEIGHT, WIDTH, 4), 77, np.uint8))
    with serving(model, tmp_path) as client:
        files = unzipped(exported(client, what="all", format=preset, colours=b64(colours))[1])
        refused = client.post("/api/export", json=asking(what="all", colours=b64(b"no picture")))
    assert files[f"{name}.png"] == colours
    assert refused.json()["error"] == "the drawing in colour is not a PNG."


def test_pictures_of_a_photo_have_room_in_a_request(model: Path, tmp_path: Path) -> None:
    grain = np.random.default_rng(0).integers(0, 256, (1300, 2048, 3), np.uint8)
    photo = io.BytesIO()
    Image.fromarray(grain).save(photo, "PNG", compress_level=0)
    art = b64(photo.getvalue())
    with serving(model, tmp_path) as client:
        files = unzipped(exported(client, what="all", line_art=art, colours=art)[1])
    assert len(2 * art) > 20 * 2**20
    assert files["fox_line.png"] == files["fox_colour.png"] == photo.getvalue()


def test_what_is_no_picture_is_no_line_art(model: Path, tmp_path: Path) -> None:
    with serving(model, tmp_path) as client:
        answer = client.post("/api/export", json=asking(what="all", line_art=b64(b"no picture")))
    assert answer.status_code == 400
    assert answer.json()["error"] == "the line art is not a PNG."


def test_a_groove_is_dark_and_a_ball_is_not() -> None:
    side = 96
    y, x = np.mgrid[:side, :side] + 0.5 - side / 2
    z = np.sqrt(np.clip(40.0**2 - x * x - y * y, 0, None))
    mask = z > 0
    ball = (np.dstack([x, -y, z]) / 40).astype(np.float32)
    light = occlusion(z.astype(np.float32), ball, mask)
    assert light[np.hypot(x, y) < 34].min() > 0.9
    assert (light[~mask] == 1).all()
    lean = np.dstack([-np.sign(x), 0 * x, np.full_like(x, 0.7)]).astype(np.float32)
    lean /= np.linalg.norm(lean, axis=-1, keepdims=True)
    dark = occlusion(np.abs(x).astype(np.float32) / 0.7, lean, np.ones((side, side), bool))
    assert dark[side // 2, side // 2] < 0.75
    assert dark[side // 2, side - 4] > 0.95


def test_an_output_of_several_files_is_encoded_once() -> None:
    encoded: list[NormalMap] = []

    class Halves(Output):
        name = "halves"

        @property
        def endings(self) -> tuple[str, ...]:
            return "_left.txt", "_right.txt"

        def encode(self, preds: NormalMap) -> dict[str, bytes]:
            encoded.append(preds)
            return dict.fromkeys(self.endings, b"half")

    normals = np.zeros((16, 16, 3), np.float32)
    normals[..., 2] = 1
    everywhere = np.ones((16, 16), bool)
    preds = NormalMap(normals, everywhere, everywhere.astype(np.float32), normals[..., 0], None, ())
    name, content = ExportRequest("fox", Halves(), None).encode(preds)
    assert name == "fox_halves.zip"
    assert unzipped(content) == {"fox_left.txt": b"half", "fox_right.txt": b"half"}
    assert len(encoded) == 1
