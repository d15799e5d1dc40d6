"""The tools as an assistant calls them: through the client of the SDK."""

import asyncio
import base64
import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from normalgan.__main__ import main
from pens import blob, outline

mcp = pytest.importorskip("mcp", reason="the extra mcp is not installed")
GREY = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)


def call(tool: str, **arguments: Any) -> Any:
    from normalgan.cli.mcp_server import make_server

    async def ask() -> Any:
        async with mcp.Client(make_server(Path(), "model.onnx")) as client:
            return await client.call_tool(tool, arguments)

    return asyncio.run(ask())


def test_infer_writes_what_generate_does(here: Path) -> None:
    Image.fromarray(GREY).save("fox.png")
    answer = call("infer", drawing="fox.png", output="maps/fox.png", green="down")
    assert not answer.is_error, answer
    assert answer.structured_content["width"] == GREY.shape[1]
    assert 0 < answer.structured_content["object_share"] < 1
    assert main(["generate", "fox.png", "--model", "model.onnx", "--y", "down"]) == 0
    assert Path("maps/fox.png").read_bytes() == Path("normals/fox_normal.png").read_bytes()


def test_sheet_paints_each_sprite(here: Path) -> None:
    Image.fromarray(np.hstack([GREY, GREY])).save("two.png")
    answer = call("sheet", drawing="two.png", output="two.exr", grid="2x1")
    assert not answer.is_error, answer
    assert answer.structured_content["sprites"] == 2
    assert Path("two.exr").exists()


def test_preview_shows_a_picture(here: Path) -> None:
    Image.fromarray(GREY).save("fox.png")
    (shown,) = call("preview", drawing="fox.png", output="lit.png").content
    picture = Image.open(io.BytesIO(base64.b64decode(shown.data)))
    assert np.asarray(picture).std() > 10
    assert Path("lit.png").exists()


def test_explain_writes_the_stages_of_the_mask_as_generate_does(here: Path) -> None:
    Image.fromarray(GREY).save("fox.png")
    answer = call("explain", drawing="fox.png", output="why")
    assert not answer.is_error, answer
    files = [Path(each) for each in answer.structured_content["files"]]
    assert [each.name for each in files] == [
        f"fox_{number}_{stage}.png"
        for number, stage in enumerate(("input", "ink", "regions", "presence", "mask"), 1)
    ]
    assert main(["generate", "fox.png", "--model", "model.onnx", "--explain", "same"]) == 0
    assert all(each.read_bytes() == Path("same", each.name).read_bytes() for each in files)
    given = call("explain", drawing="fox.png", output="given", mask="model")
    assert [Path(each).name for each in given.structured_content["files"]][-1] == "fox_5_mask.png"
    assert "lies outside" in call("explain", drawing="fox.png", output="../why").content[0].text


def test_a_sprite_has_the_details_that_generate_gives_it(here: Path) -> None:
    Image.fromarray(GREY).save("fox.png")
    assert not call(
        "infer", drawing="fox.png", output="a.png", detail=0.5, pixel_art=True, form="flat"
    ).is_error
    options = ["--detail", "0.5", "--pixel-art", "--form", "flat"]
    assert main(["generate", "fox.png", "--model", "model.onnx", *options]) == 0
    assert Path("a.png").read_bytes() == Path("normals/fox_normal.png").read_bytes()
    pinned = [{"x": 1, "y": 1, "normal": [0, 0, 1]}]
    answer = call("infer", drawing="fox.png", output="b.png", form="flat", hints=pinned)
    assert "form overrides hints" in answer.content[0].text
    answer = call("infer", drawing="fox.png", output="b.png", detail=2)
    assert "detail of Sprite is 2.0; it must be from 0 to 1" in answer.content[0].text


@pytest.mark.parametrize("tool", ["infer", "preview", "sheet"])
def test_the_drawing_is_not_written_over(here: Path, tool: str) -> None:
    Image.fromarray(GREY).save("fox.png")
    before = Path("fox.png").read_bytes()
    answer = call(tool, drawing="fox.png", output="./fox.png")
    assert "./fox.png is an input and would be overwritten" in answer.content[0].text
    assert Path("fox.png").read_bytes() == before


def test_a_preview_is_a_png(here: Path) -> None:
    Image.fromarray(GREY).save("fox.png")
    answer = call("preview", drawing="fox.png", output="lit.jpg")
    assert "the preview lit.jpg must end in .png." in answer.content[0].text
    assert not Path("lit.jpg").exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"drawing": "gone.png", "output": "a.png"}, "there is no file"),
        ({"drawing": "fox.png", "output": "a.jpg"}, "must end in one of .png .exr"),
        ({"drawing": "fox.png", "output": "../a.png"}, "../a.png lies outside"),
        ({"drawing": "fox\0.png", "output": "a.png"}, r"'fox\x00.png' is not the name of a file."),
        ({"drawing": "/etc/hostname", "output": "a.png"}, "/etc/hostname lies outside"),
        ({"drawing": "fox.png", "output": "a.png", "hints": [{"x": 1}]}, "a hint has x, y"),
        (
            {"drawing": "fox.png", "output": "a.png", "gren": "down"},
            "infer has no argument gren. Did you mean green? Known: drawing, output, hints, ",
        ),
    ],
)
def test_bad_input_is_reported_to_the_assistant(here: Path, arguments: dict[str, Any], sentence: str) -> None:
    Image.fromarray(GREY).save("fox.png")
    answer = call("infer", **arguments)
    assert answer.is_error
    assert sentence in answer.content[0].text
    assert not Path("a.png").exists()
