"""Animations: all frames in, the same kind out; on real files."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image, ImageSequence, TiffImagePlugin

from normal_pngs import read_png
from normalgan.__main__ import main
from normalgan.decoding import decode_frames
from normalgan.errors import InputError
from normalgan.inference.composites.animation import Kind, encode_animation, moving_kind
from normalgan.inference.composites.steadying import steadied
from normalgan.inference.outputs.engines import CONVENTIONS, Engine
from pens import blob, outline

Pixels = NDArray[np.uint8]
FRAMES = [blob((80, 120), (40 + 8 * i, 44), 20) for i in range(4)]
DURATIONS = [80, 120, 40, 200]


def generate(*arguments: str) -> int:
    return main(["generate", *arguments, "--model", "model.onnx"])


def pen(filled: NDArray[np.float32]) -> Pixels:
    return np.rint(255 * (1 - outline(filled))).astype(np.uint8)


def animate(name: str, frames: list[Pixels] | None = None, **settings: Any) -> None:
    first, *rest = (Image.fromarray(each) for each in frames or [pen(each) for each in FRAMES])
    settings = {"lossless": True} | settings if name.endswith("webp") else settings
    first.save(
        name, save_all=True, append_images=rest, duration=DURATIONS[: 1 + len(rest)], loop=0, **settings
    )


def frames_of(path: str) -> tuple[list[Pixels], list[int], int]:
    with Image.open(path) as image:
        loop = image.info.get("loop", 1)
        shown = [
            (np.asarray(each.convert("RGBA")), int(each.info["duration"]))
            for each in ImageSequence.Iterator(image)
        ]
    return [pixels for pixels, _ in shown], [duration for _, duration in shown], loop


def test_each_page_of_a_tiff_gets_a_map_of_its_own(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pages = [Image.fromarray(pen(each)) for each in FRAMES[:2]]
    wide = Image.fromarray(np.pad(pen(FRAMES[0]), ((0, 0), (0, 40)), constant_values=255))
    copy = TiffImagePlugin.ImageFileDirectory_v2()
    copy[254] = 1  # a small copy, such as cameras write, is no page
    writer: Any = TiffImagePlugin.AppendingTiffWriter
    content = io.BytesIO()  # a file of its own Pillow's writer would close twice
    with writer(content) as file:
        for page, tags in (
            (pages[0], None),
            (pages[0].resize((30, 20)), copy),
            (wide, None),
            (pages[1], None),
        ):
            page.save(file, format="TIFF", **({"tiffinfo": tags} if tags else {}))
            file.newFrame()
    Path("three.tiff").write_bytes(content.getvalue())
    assert generate("three.tiff", "--preview", "png") == 0
    maps = [f"normals/three_{number:04d}_normal.png" for number in (1, 2, 3)]
    assert capsys.readouterr().out.splitlines() == maps
    names = [f"three_{number:04d}_{kind}.png" for number in (1, 2, 3) for kind in ("normal", "preview")]
    assert sorted(path.name for path in Path("normals").iterdir()) == names
    assert np.asarray(Image.open("normals/three_0002_normal.png")).shape[1::-1] == wide.size
    for number, each in ((1, pages[0]), (3, pages[1])):
        each.save("one.png")
        assert generate("one.png") == 0
        alone, again = (
            np.asarray(Image.open(f"normals/{name}_normal.png")) for name in ("one", f"three_{number:04d}")
        )
        np.testing.assert_array_equal(again, alone)
    assert generate("three.tiff", "--split", "auto") == 2
    assert "three.tiff has several pages; a sheet is a still picture" in capsys.readouterr().err


@pytest.mark.parametrize("kind", ["gif", "webp", "png"])
def test_all_frames_come_in_and_go_out_as_the_same_kind(here: Path, kind: str) -> None:
    animate(f"walk.{kind}")
    assert generate(f"walk.{kind}", "--frame", "own") == 0
    assert [path.name for path in Path("normals").iterdir()] == [f"walk_normal.{kind}"]
    frames, durations, loop = frames_of(f"normals/walk_normal.{kind}")
    assert durations == DURATIONS
    assert loop == 0
    for number, each in enumerate(FRAMES):
        Image.fromarray(pen(each)).save("one.png")
        assert generate("one.png") == 0
        alone = np.asarray(Image.open("normals/one_normal.png")).astype(int)
        off = np.abs(frames[number][..., :3] - alone)
        assert off.max() == 0 if kind != "gif" else off.mean() < 2, number


@pytest.mark.parametrize("kind", ["gif", "webp", "png"])
def test_opacity_moves_along(here: Path, kind: str) -> None:
    sprites = [
        np.dstack([np.full((*each.shape, 3), 120), 255 * (each > 0.5)]).astype(np.uint8) for each in FRAMES
    ]
    animate(f"hop.{kind}", sprites, disposal=2) if kind != "webp" else animate("hop.webp", sprites)
    assert generate(f"hop.{kind}", "--alpha") == 0
    frames, _, _ = frames_of(f"normals/hop_normal.{kind}")
    for found, sprite in zip(frames, sprites, strict=True):
        assert np.array_equal(found[..., 3] > 127, sprite[..., 3] > 127)


def test_what_does_not_fit_in_an_animation_is_written_frame_by_frame(here: Path) -> None:
    animate("walk.gif")
    assert generate("walk.gif", "--bits", "16", "--show-input") == 0
    expected = {f"walk_{n:04d}_{what}.png" for n in (1, 2, 3, 4) for what in ("normal", "input")}
    assert {path.name for path in Path("normals").iterdir()} == expected


@pytest.mark.parametrize("engine", ["unity", "unreal", "godot"])
def test_frames_for_an_engine_are_pictures_that_it_imports(
    here: Path, capsys: pytest.CaptureFixture[str], engine: Engine
) -> None:
    animate("walk.webp", [pen(each) for each in FRAMES[:2]])
    assert generate("walk.webp", "--engine", engine, "--preview", "png") == 0
    maps = sorted(Path("normals").glob(f"walk_000[12]{CONVENTIONS[engine].suffix}.png"))
    assert [str(each) for each in maps] == capsys.readouterr().out.splitlines()
    assert len(maps) == 2
    for each in maps:
        assert each.with_name(each.name + CONVENTIONS[engine].sidecar).is_file()
    assert not list(Path("normals").glob("*.webp"))
    assert generate("walk.webp", "--engine", engine, "-o", "one.png") == 2
    assert "one.png holds one map, but walk.webp has several pictures" in capsys.readouterr().err
    assert not list(here.glob("one*"))


def test_a_frame_for_all_keeps_what_stands_still(here: Path) -> None:
    """A body stands, and an arm is stretched out: in one frame for all the ramp stays where it was."""
    body = blob((80, 120), (40, 44), 20)
    frames = []
    for i in range(4):
        drawn = body.copy()
        drawn[40:46, 55 : 75 + 12 * i] = 1
        frames.append(pen(drawn))
    animate("wave.png", frames)
    flicker = {}
    for frame in ("own", "shared"):
        assert generate("wave.png", "--frame", frame, "-o", frame) == 0
        shown, _, _ = frames_of(f"{frame}/wave_normal.png")
        flicker[frame] = np.ptp(np.stack(shown).astype(int)[:, 40:60, 25:45], axis=0).mean()
    assert flicker["shared"] < 0.5  # of 255
    assert flicker["own"] > 2


def test_what_moves_as_a_whole_is_shown_as_if_it_stood_still(here: Path) -> None:
    animate("moves.gif")
    for folder, more in (("default", ()), ("own", ("--frame", "own"))):
        assert generate("moves.gif", "-o", folder, "--bits", "16", *more) == 0
    for i in range(1, 5):
        name = f"moves_000{i}_normal.png"
        assert np.abs(read_png(Path("default", name))[0] - read_png(Path("own", name))[0]).max() < 0.02


def test_files_of_one_size_share_a_frame(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for number, each in enumerate(FRAMES):
        Image.fromarray(pen(each)).save(f"walk_{number}.png")
    animate("walk.png")
    assert generate("walk.png") == generate(*[f"walk_{n}.png" for n in range(4)], "--frame", "shared") == 0
    together, _, _ = frames_of("normals/walk_normal.png")
    for number, frame in enumerate(together):
        alone = np.asarray(Image.open(f"normals/walk_{number}_normal.png"))
        assert np.array_equal(frame[..., :3], alone), number
    Image.fromarray(pen(blob())).save("large.png")
    assert generate("walk_0.png", "large.png", "--frame", "shared") == 2
    assert "cannot share a frame" in capsys.readouterr().err


def test_neighbours_steady_only_what_they_share() -> None:
    rng = np.random.default_rng(3)
    lines = np.zeros((64, 64), np.float32)
    lines[8:56, 30] = 1
    seen = [lines.copy() for _ in range(3)]
    seen[1][40:60, 44:60] = 1
    base = rng.normal(size=(64, 64, 3))
    preds = [(base + 0.005 * rng.normal(size=base.shape)).astype(np.float32) for _ in seen]
    preds[1][44:56, 46:58] += 1
    after = steadied(seen, preds)
    assert np.abs(after[0] - after[2])[:30, :20].max() < 1e-3  # nothing moves there
    assert np.abs(after[0] - np.mean(preds, 0))[:30, :20].max() < 1e-2
    assert np.abs(after[1] - preds[1])[48:52, 48:56].max() < 0.05  # there it does


def test_what_has_moved_on_is_not_averaged_where_both_frames_are_blank() -> None:
    """The middle of a ball is blank in each frame, and its normals differ from each frame to the next."""
    rows, columns = np.mgrid[:128, :128].astype(np.float32)
    seen, preds = [], []
    for number in range(5):
        x, y = (columns - 40 - 6 * number) / 30, (64 - rows) / 30
        away = np.hypot(x, y)
        seen.append(np.clip(1.5 - 30 * np.abs(away - 1), 0, 1).astype(np.float32))
        ball = np.stack([x, y, np.sqrt(np.maximum(1 - away**2, 0))], -1)
        preds.append(np.where(away[..., None] < 1, ball, 0).astype(np.float32))
    for own, after in zip(preds, steadied(seen, preds), strict=True):
        inside = np.linalg.norm(own, axis=-1) > 0.5
        kept = (after / np.maximum(np.linalg.norm(after, axis=-1, keepdims=True), 1e-6) * own).sum(-1)
        assert np.rad2deg(np.arccos(np.clip(kept[inside], -1, 1))).max() < 2


@pytest.mark.parametrize("transparent", [False, True])
@pytest.mark.parametrize("kind", ["gif", "webp", "png"])
def test_equal_frames_stay_frames(here: Path, kind: Kind, transparent: bool) -> None:
    a, b = (np.full((24, 32, 4 if transparent else 3), value, np.uint8) for value in (40, 200))
    a[4:20, 6:20] = 120
    a[..., 3:], b[..., 3:] = 0, 255
    a[4:20, 6:20, 3:] = 255
    frames, durations = [a, a, b, b, b], [80, 90, 100, 110, 120]
    for many in (frames, frames[:2]):
        waits = durations[: len(many)]
        name = f"walk.{kind}"
        Path(name).write_bytes(encode_animation(kind, many, waits, 0))
        found, shown, loop = frames_of(name)
        assert shown == waits
        assert loop == 0
        for got, wanted in zip(found, many, strict=True):
            opaque = wanted[..., 3] > 127 if transparent else np.ones(wanted.shape[:2], bool)
            assert np.array_equal(got[..., 3] > 127, opaque)
            assert np.abs(got[..., :3].astype(int) - wanted[..., :3])[opaque].max(initial=0) <= 2


def broken(name: str) -> None:
    data = Path(name).read_bytes()
    Path(name).write_bytes(data[: len(data) * 3 // 4])


@pytest.mark.parametrize("kind", ["gif", "webp", "png"])
def test_a_broken_animation_is_told_in_a_sentence(
    here: Path, kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    animate(f"walk.{kind}")
    broken(f"walk.{kind}")
    assert generate(f"walk.{kind}") == 2
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1
    assert f"walk.{kind}" in said
    assert "broken" in said or "cannot be read" in said
    assert not Path("normals").exists()


def test_a_gif_that_ends_in_its_head_is_told_in_a_sentence() -> None:
    with pytest.raises(InputError, match=r"a\.gif is broken: it ends within its frame 1"):
        moving_kind(Path("a.gif"), b"GIF89G\x18\0\0")


def test_a_still_picture_of_these_kinds_stays_one(here: Path) -> None:
    for kind in ("gif", "webp", "png"):
        Image.fromarray(pen(FRAMES[0])).save(f"still_{kind}.{kind}")
        assert generate(f"still_{kind}.{kind}") == 0
        assert Path(f"normals/still_{kind}_normal.png").is_file()


@pytest.mark.slow
def test_an_animation_of_too_many_pixels_is_refused() -> None:
    import io

    frames = [Image.new("L", (1000, 1000), n) for n in range(80)]
    file = io.BytesIO()
    frames[0].save(file, "GIF", save_all=True, append_images=frames[1:])
    with pytest.raises(InputError, match="has 80 frames of 80000000 pixels together"):
        decode_frames("large.gif", file.getvalue(), (8, 8192))


def test_a_frame_that_is_larger_than_its_animation_is_refused_before_it_is_unpacked(here: Path) -> None:
    animate("walk.gif")
    data = bytearray(Path("walk.gif").read_bytes())
    at = data.index(b"\x2c", data.index(b"\x2c\0\0\0\0") + 20)
    while data[at - 8 : at - 5] != b"\x21\xf9\x04":  # a picture's head comes after its control block
        at = data.index(b"\x2c", at + 1)
    data[at + 5 : at + 9] = b"\0\x2f\0\x2f"  # 12032 x 12032
    with pytest.raises(InputError, match=r"frame 2"):
        decode_frames("walk.gif", bytes(data), (8, 8192))
    data[at + 5 : at + 9] = b"\xc8\0\xc8\0"  # 200 x 200
    with pytest.raises(InputError, match="has a frame 2 that reaches beyond its 120 × 80 pixels"):
        decode_frames("walk.gif", bytes(data), (8, 8192))


def test_a_frame_without_lines_is_left_flat_and_named(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    animate("blink.png", [pen(FRAMES[0]), np.full((80, 120), 255, np.uint8), pen(FRAMES[1])])
    Path("x").mkdir()
    assert generate("blink.png") == 0
    assert "frame 2: it is left flat, because no lines were found in it" in capsys.readouterr().err
    frames, _, _ = frames_of("normals/blink_normal.png")
    assert (frames[1][..., :3] == (128, 128, 255)).all()
    grain = np.full((80, 120), 255, np.uint8)
    grain[40, 40] = 250
    animate("grain.png", [pen(FRAMES[0]), grain, pen(FRAMES[1])])
    assert generate("grain.png") == 1  # something is drawn on it
    assert "some frames or layers of 1 of 1 sketches could not be used" in capsys.readouterr().err
    assert generate("blink.png", "--sheet", "2x1") == 2
    assert "blink.png is an animation; a sheet is a still picture." in capsys.readouterr().err
