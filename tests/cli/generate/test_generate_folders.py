"""Folders, files and what a shell user expects of normalgan generate."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from shutil import rmtree
from typing import Any

import numpy as np
import pytest
from PIL import Image

from normalgan.__main__ import main
from normalgan.decoding import DecodedLayer
from normalgan.inference.composites.layers import encode_layers
from normalgan.inference.jobs.writing import Writer
from pens import blob, outline

GREY = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)


def draw(*names: str) -> None:
    for name in names:
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(GREY).save(name)


def draw_layers(name: str) -> None:
    """Write an OpenRaster file of one layer, 120 × 80."""
    pixels = np.asarray(Image.fromarray(GREY).resize((120, 80)).convert("RGBA"))
    layer = DecodedLayer("body", (), 255, 0, 0, 0, 0, pixels)
    Path(name).write_bytes(encode_layers("ora", (80, 120), [layer]))


def generate(*arguments: str) -> int:
    return main(["generate", "--model", "model.onnx", *arguments])


def written(folder: str) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in Path(folder).rglob("*") if path.is_file()}


@pytest.mark.slow
def test_a_tree_is_searched_and_mirrored(here: Path) -> None:
    draw("in/fox.png", "in/deep/fox.png", "in/deep/er/owl.png", "in/.hidden/no.png")
    assert generate("in", "-o", "flat") == 0
    assert written("flat") == {"fox_normal.png"}
    for _ in range(2):  # the second time the maps are not taken for drawings
        assert generate("in", "--recursive", "-o", "in/maps") == 0
        names = {"fox_normal.png", "deep/fox_normal.png", "deep/er/owl_normal.png"}
        assert written("in/maps") == names
    assert generate("in", "--recursive", "-o", "in") == 0
    assert "deep/fox_normal_normal.png" not in written("in")


def test_masks_mirror_the_tree(here: Path) -> None:
    draw("in/a/fox.png", "in/b/fox.png")
    for folder, box in (("a", np.s_[60:90, 150:180]), ("b", np.s_[80:130, 140:200])):
        mask = np.zeros((200, 300), np.uint8)
        mask[box] = 255
        Path(f"masks/{folder}").mkdir(parents=True)
        Image.fromarray(mask).save(f"masks/{folder}/fox_mask.png")
    assert generate("in", "--recursive", "--mask", "masks", "--alpha", "-o", "out") == 0
    areas = [int((np.asarray(Image.open(f"out/{one}/fox_normal.png"))[..., 3] > 127).sum()) for one in "ab"]
    assert areas[0] < 1200
    assert areas[1] > 2000


def test_one_name_in_different_folders_is_no_error(here: Path) -> None:
    draw("a/fox.png", "b/fox.png", "b/owl.png")
    assert generate("a/fox.png", "b/fox.png", "b/owl.png") == 0
    assert written("normals") == {"a/fox_normal.png", "b/fox_normal.png", "owl_normal.png"}


def test_one_bad_path_stops_no_other(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    draw("fox.png", "owl.png")
    assert generate("fox.png", "missing.png", "owl.png", "none/*.png") == 1
    assert written("normals") == {"fox_normal.png", "owl_normal.png"}
    said = capsys.readouterr().err
    assert "no sketch found at 'missing.png'" in said
    assert "no sketch found at 'none/*.png'" in said
    assert "2 of 4 sketches could not be used" in said
    assert generate("missing.png", "gone.png") == 2


def test_the_picture_beside_a_layered_file_is_its_export(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("in/fox.png", "in/owl.png")
    draw_layers("in/fox.ora")
    draw_layers("in/hen.ora")
    assert generate("in") == 0
    assert written("normals") == {"fox_normal.png", "owl_normal.png", "hen_normal.png"}
    assert np.asarray(Image.open("normals/fox_normal.png")).shape[:2] == (200, 300)
    said = capsys.readouterr().err
    assert f"{Path('in/fox.ora')} is skipped, because fox.png next to it is its export." in said
    assert generate("in/fox.ora", "in/fox.png", "--layers", "-o", "layers") == 0
    assert written("layers") == {"fox_normal.ora"}
    assert (
        f"{Path('in/fox.png')} is skipped, because fox.ora next to it has its layers."
        in capsys.readouterr().err
    )
    assert generate("in/fox.ora", "-o", "alone") == 0
    assert np.asarray(Image.open("alone/fox_normal.png")).shape[:2] == (80, 120)


def test_among_layered_files_a_flat_drawing_is_predicted_as_it_is(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("in/owl.png", "in/hen.png", "in/hen.bmp")
    draw_layers("in/fox.ora")
    for arguments in (["--dry-run"], []):
        assert generate("in", "--layers", *arguments) == 1  # two are named hen
        said = capsys.readouterr()
        assert said.err.count("would be written twice") == 2
        assert str(Path("normals/owl_normal.png")) in said.out
    assert written("normals") == {"fox_normal.ora", "owl_normal.png"}
    assert f"{Path('in/owl.png')}: it has no layers and is predicted as it is." in said.err


def test_drawings_of_one_name_do_not_stop_the_others(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    draw("in/fox.png", "in/fox.bmp", "in/owl.png")
    for extra in (["--dry-run"], []):
        assert generate("in", *extra) == 1
        said = capsys.readouterr()
        target = Path("normals/fox_normal.png")
        assert f"{Path('in/fox.bmp')}: {target} would be written twice; rename a sketch" in said.err
        assert f"{Path('in/fox.png')}: {target} would be written twice" in said.err
        assert "fox" not in said.out
        assert "owl_normal.png" in said.out
    assert "2 of 3 sketches could not be used" in said.err
    assert written("normals") == {"owl_normal.png"}
    capsys.readouterr()
    assert generate("in/fox.png", "in/fox.bmp") == 2
    assert capsys.readouterr().err.count("would be written twice") == 2


@pytest.mark.slow
def test_animations_of_one_name_and_different_kinds_are_files_of_their_own(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("in").mkdir()
    first, second = Image.fromarray(GREY), Image.fromarray(GREY[:, ::-1].copy())
    first.save("in/walk.png")
    for kind in ("gif", "webp"):
        first.save(f"in/walk.{kind}", save_all=True, append_images=[second], duration=100)
    first.save("in/run.apng", "PNG", save_all=True, append_images=[second], duration=100)
    assert generate("in") == 0
    assert written("normals") == {"walk_normal.png", "walk_normal.gif", "walk_normal.webp", "run_normal.png"}
    for arguments in (["--bits", "16"], ["--ao"]):  # a file for each frame, of either
        assert generate("in", "-o", "frames", *arguments) == 1
        assert "walk_0001_" in capsys.readouterr().err


def test_existing_maps_can_be_skipped(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    draw("fox.png", "owl.png")
    assert generate("fox.png") == 0
    before = Path("normals/fox_normal.png").stat().st_mtime_ns
    capsys.readouterr()
    assert generate("fox.png", "owl.png", "--skip-existing") == 0
    said = capsys.readouterr()
    assert said.out.split() == [str(Path("normals/owl_normal.png"))]
    assert "1 of 2 sketches already have a map" in said.err
    assert Path("normals/fox_normal.png").stat().st_mtime_ns == before
    assert generate("fox.png", "--skip-existing") == 0


def test_with_skip_existing_only_missing_files_are_written(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("fox.png")
    assert generate("fox.png") == 0
    Path("normals/fox_normal.png").write_bytes(b"edited by hand")
    capsys.readouterr()
    for _ in range(2):
        assert generate("fox.png", "--skip-existing", "--height", "png") == 0
        assert written("normals") == {"fox_normal.png", "fox_height.png"}
        assert Path("normals/fox_normal.png").read_bytes() == b"edited by hand"
        said = capsys.readouterr()
        assert not said.out
    assert "1 of 1 sketches already have a map" in said.err


def draw_frames() -> None:
    """Write three frames in which an arm of different length reaches out of a body."""
    Path("in").mkdir()
    for number, reach in enumerate((0, 60, 110), 1):
        body = blob(centre=(90, 120))
        body[110:130, 90 : 150 + reach] = 1
        drawn = np.rint(255 * (1 - outline(body))).astype(np.uint8)
        Image.fromarray(drawn).save(f"in/walk{number}.png")


def test_a_missing_frame_is_predicted_with_the_others(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    draw_frames()
    shared = "in", "--frame", "shared", "--height", "png"
    assert generate(*shared) == 0
    lost = [Path("normals/walk1_normal.png"), Path("normals/walk1_height.png")]
    before = [path.read_bytes() for path in lost]
    for path in lost:
        path.unlink()
    capsys.readouterr()
    assert generate(*shared, "--skip-existing") == 0
    assert capsys.readouterr().out.split() == [str(lost[0])]
    assert [path.read_bytes() for path in lost] == before
    assert generate(*shared, "--skip-existing") == 0
    assert not capsys.readouterr().out


def test_heights_of_frames_in_separate_files_have_one_scale(here: Path) -> None:
    Path("in").mkdir()
    for radius in (40, 50, 60):
        drawn = np.rint(255 * (1 - outline(blob(radius=radius)))).astype(np.uint8)
        Image.fromarray(drawn).save(f"in/ball{radius}.png")
    for scale, given in (("own", []), ("shared", ["--frame", "shared"])):
        assert generate("in", *given, "--height", "png", "-o", scale) == 0
    most = {
        scale: [int(np.asarray(Image.open(path)).max()) for path in sorted(Path(scale).glob("*_height.png"))]
        for scale in ("own", "shared")
    }
    assert most["own"] == [65535] * 3
    assert max(most["shared"]) == 65535
    assert min(most["shared"]) < 65535


@pytest.mark.parametrize(
    ("arguments", "name"),
    [(["-fox.png"], "-fox"), (["--", "-fox.png"], "-fox"), (["--bits", "8", "--", "fox.png"], "fox")],
)
def test_names_that_begin_with_a_dash_are_names(here: Path, arguments: list[str], name: str) -> None:
    draw("fox.png")
    Path("fox.png").write_bytes(Path("fox.png").read_bytes())
    Image.fromarray(GREY).save(here / "-fox.png")
    assert generate("-o", "out", *arguments) == 0
    assert written("out") == {f"{name}_normal.png"}


def test_one_drawing_and_a_file_name_are_that_file(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    draw("fox.png", "owl.png")
    assert generate("fox.png", "-o", "x.png", "--height", "png") == 0
    assert generate("fox.png", "-o", "deep/y.exr") == 0
    assert generate("fox.png") == 0
    assert {"x.png", "x_height.png", "deep/y.exr"} <= written(".")
    assert Path("x.png").read_bytes() == Path("normals/fox_normal.png").read_bytes()
    assert Path("deep/y.exr").read_bytes()[:4] == b"\x76\x2f\x31\x01"
    for arguments, sentence in (
        (["fox.png", "owl.png", "-o", "z.png"], "z.png is one file, but there are 2 sketches"),
        (["fox.png", "-o", "z.png", "--format", "exr"], "z.png is not exr"),
        (["fox.png", "-o", "z.exr", "--format", "png"], "z.exr is not png; name a file of that kind"),
        (["fox.png", "-o", "z.gif"], "z.gif would be an animation, but fox.png is a still image."),
        (["fox.png", "-o", "fox.png"], "fox.png is an input and would be overwritten"),
        (["fox.png", "-o", ""], "--output is empty; name a file or a folder, such as '.'."),
        (["fox.png", "--mask", ""], "--mask is empty; name a file or a folder, such as '.'."),
    ):
        capsys.readouterr()
        assert generate(*arguments) == 2
        assert sentence in capsys.readouterr().err
    Path("m.png").write_bytes(Path("model.onnx").read_bytes())
    assert generate("fox.png", "-o", "m.png", "--model", "m.png") == 2
    assert "m.png is an input and would be overwritten" in capsys.readouterr().err
    assert Path("m.png").read_bytes() == Path("model.onnx").read_bytes()
    Path("folder.png").mkdir()
    assert generate("fox.png", "-o", "folder.png") == 0
    assert written("folder.png") == {"fox_normal.png"}


def test_a_map_goes_to_standard_output(here: Path, capfdbinary: pytest.CaptureFixture[bytes]) -> None:
    draw("fox.png", "owl.png")
    Path("broken.png").write_bytes(b"no picture")
    assert generate("fox.png") == 0
    capfdbinary.readouterr()
    assert generate("fox.png", "-o", "-") == 0
    assert capfdbinary.readouterr().out == Path("normals/fox_normal.png").read_bytes()
    for arguments, sentence in (
        (["fox.png", "owl.png"], b"standard output holds one map, but there are 2"),
        (["fox.png", "broken.png"], b"standard output holds one map, but there are 2"),  # nor is one painted
        (["fox.png", "--height", "png"], b"standard output only holds the map"),
        (["fox.png", "--watch"], b"standard output holds one map; --watch"),
    ):
        assert generate(*arguments, "-o", "-") == 2
        said = capfdbinary.readouterr()
        assert sentence in said.err
        assert not said.out


@pytest.mark.parametrize("name", ["fox.jpg", "fox.TGA", "fox.psd", "walk.mp4"])
def test_no_folder_is_made_of_the_name_of_a_file(
    here: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("fox.png")
    assert generate("fox.png", "-o", f"out/{name}") == 2
    assert f"{name} is not a supported file name for a map; use .png, .exr" in capsys.readouterr().err
    assert not Path("out").exists()
    Path("out", name).mkdir(parents=True)
    assert generate("fox.png", "-o", f"out/{name}") == 0
    assert written(f"out/{name}") == {"fox_normal.png"}


def test_unwritable_outputs_are_reported_before_inference(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("fox.png")
    Path("dir/fox_normal.png").mkdir(parents=True)
    for extra in ([], ["--dry-run"]):
        for output in ("fox.png/out", "dir", *(["/proc/normals"] if sys.platform == "linux" else [])):
            assert generate("fox.png", "-o", output, *extra) == 2, output
            said = capsys.readouterr()
            assert "the normal map cannot be written to" in said.err
            assert not said.out


def test_a_watch_predicts_saved_drawings_until_the_folder_is_removed(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("in/fox.png")
    looks = 0

    def wait(_: float) -> None:
        nonlocal looks
        looks += 1
        if looks == 2:
            draw("in/owl.png")
            Path("in/half.png").write_bytes(b"\x89PNG")
        if looks == 5:
            os.utime("in/fox.png", ns=(1, 1))
        if looks == 8:
            rmtree("in")

    monkeypatch.setattr("time.sleep", wait)
    assert generate("in", "--watch") == 1
    said = capsys.readouterr()
    names = [Path(line).name for line in said.out.split()]
    assert names == ["fox_normal.png", "owl_normal.png", "fox_normal.png"]
    assert "half.png cannot be read as an image" in said.err
    assert "the watched folder in no longer exists." in said.err


def test_a_watch_begins_empty_and_survives_names_that_clash(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("my.art").mkdir()
    assert generate("my.art") == 2
    assert "no sketch found at 'my.art'" in capsys.readouterr().err
    looks = 0

    def wait(_: float) -> None:
        nonlocal looks
        looks += 1
        if looks == 2:
            draw("my.art/fox.png")
        if looks == 5:
            draw("my.art/fox.bmp")
        if looks == 8:
            Path("my.art/fox.bmp").rename("my.art/owl.bmp")
        if looks == 11:
            rmtree("my.art")

    monkeypatch.setattr("time.sleep", wait)
    assert generate("my.art", "--watch") == 1
    said = capsys.readouterr()
    assert [Path(line).name for line in said.out.split()] == ["fox_normal.png", "owl_normal.png"]
    assert said.err.count("would be written twice") == 2  # of each drawing once
    assert "the watched folder my.art no longer exists." in said.err
    assert "no sketch" not in said.err


def watched(monkeypatch: pytest.MonkeyPatch, *steps: Callable[[], object]) -> None:
    """Do something at every third look of a watch, and remove its folder in the end."""
    every: list[Callable[[], object]] = [*steps, partial(rmtree, "in")]
    looks = 0

    def wait(_: float) -> None:
        nonlocal looks
        if looks % 3 == 2:
            every[looks // 3]()
        looks += 1

    monkeypatch.setattr("time.sleep", wait)


def predicted(said: str) -> list[str]:
    return [Path(line).name.removesuffix("_normal.png") for line in said.split()]


def test_a_watch_with_skip_existing_predicts_only_changed_drawings(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("in/fox.png", "in/owl.png")
    assert generate("in/owl.png") == 0
    capsys.readouterr()
    watched(monkeypatch, lambda: None, lambda: os.utime("in/owl.png", ns=(1, 1)))
    assert generate("in", "--skip-existing", "--watch") == 1
    assert predicted(capsys.readouterr().out) == ["fox", "owl"]


def test_a_watch_sees_drawings_saved_during_inference(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("in/fox.png")
    write = Writer.write

    def write_and_save(*arguments: Any) -> Any:
        monkeypatch.setattr(Writer, "write", write)
        os.utime("in/fox.png", ns=(1, 1))
        return write(*arguments)

    monkeypatch.setattr(Writer, "write", write_and_save)
    watched(monkeypatch, lambda: None)
    assert generate("in", "--watch") == 1
    assert predicted(capsys.readouterr().out) == ["fox", "fox"]


def test_the_map_of_a_drawing_that_is_deleted_is_no_drawing(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("in/fox.png")
    watched(monkeypatch, lambda: Path("in/fox.png").rename("in/owl.png"), lambda: None)
    assert generate("in", "--watch", "--ao", "-o", "in") == 1
    assert predicted(capsys.readouterr().out) == ["fox", "owl"]


def test_hints_masks_and_atlases_are_watched_too(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("in/fox.png", "in/owl.png")
    Image.fromarray(np.full(GREY.shape, 255, np.uint8)).save("in/owl_mask.png")
    watched(
        monkeypatch,
        lambda: Path("in/fox_hints.json").write_text('[{"x": 150, "y": 80, "normal": [0.6, 0, 0.8]}]'),
        lambda: os.utime("in/owl_mask.png", ns=(1, 1)),
    )
    Path("in/owl_hints.json").write_text('[{"x": 150, "y": 80, "normal": [0.6, 0, 0.8]}]')
    assert generate("in", "--watch", "--hints", "in", "--mask", "in") == 1
    assert predicted(capsys.readouterr().out) == ["fox", "owl", "fox", "owl"]
    draw("in/fox.png")
    frame = {"frame": {"x": 0, "y": 0, "w": 300, "h": 200}}
    Path("in/fox.json").write_text(json.dumps({"frames": {"fox": frame}}))
    watched(monkeypatch, lambda: os.utime("in/fox.json", ns=(1, 1)))
    assert generate("in", "--watch", "--atlas", "in") == 1
    assert predicted(capsys.readouterr().out) == ["fox", "fox"]


def test_a_watch_predicts_all_drawings_of_a_shared_frame_again(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("in/walk_1.png", "in/walk_2.png")
    watched(
        monkeypatch,
        lambda: Image.fromarray(GREY).resize((120, 80)).save("in/walk_2.png"),  # half of a change of size
        lambda: Image.fromarray(GREY[:, ::-1].copy()).save("in/walk_2.png"),
    )
    assert generate("in", "--watch", "--frame", "shared") == 1
    said = capsys.readouterr()
    assert predicted(said.out) == ["walk_1", "walk_2", "walk_1", "walk_2"]
    assert "cannot share a frame" in said.err
    before = {name: Path("normals", name).read_bytes() for name in written("normals")}
    draw("in/walk_1.png")
    Image.fromarray(GREY[:, ::-1].copy()).save("in/walk_2.png")
    assert generate("in", "--frame", "shared") == 0
    assert {name: Path("normals", name).read_bytes() for name in written("normals")} == before


def test_a_watch_refuses_a_common_height_scale(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    draw("in/fox.png")
    assert generate("in", "--watch", "--height", "png", "--height-scale", "batch") == 2
    assert "--height-scale batch needs all drawings at once" in capsys.readouterr().err


@pytest.mark.slow  # two processes, of which one converts fifty drawings
def test_a_long_batch_takes_the_memory_of_a_short_one(here: Path) -> None:
    small = Image.fromarray(GREY).resize((120, 80))
    Path("in").mkdir()
    for i in range(50):
        small.save(f"in/{i:03d}.png")
    script = (
        "import resource, sys; from normalgan.__main__ import main; "
        "assert main(sys.argv[1:]) == 0; "
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, file=sys.stderr)"
    )
    peaks = []
    for pattern in ("in/00[0-4].png", "in/*.png"):
        arguments = ["generate", pattern, "--model", "model.onnx", "--bits", "16"]
        ran = subprocess.run(
            [sys.executable, "-c", script, *arguments], check=True, capture_output=True, text=True
        )
        peaks.append(int(ran.stderr.split()[-1]))
    assert peaks[1] < 1.1 * peaks[0]


def test_onnx_runtime_sends_no_telemetry(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import onnxruntime

    told = []
    monkeypatch.setattr(onnxruntime, "disable_telemetry_events", lambda: told.append("off"))
    draw("fox.png")
    assert generate("fox.png") == 0
    assert told == ["off"]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows limits whole paths, not names")
def test_a_name_that_is_too_long_is_told_by_a_dry_run(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    long = "x" * 250
    draw(f"in/{long}.png", "in/fox.png")
    assert generate("in", "--dry-run") == 1
    told = capsys.readouterr()
    assert told.out.splitlines() == ["in/fox.png -> normals/fox_normal.png"]
    assert f"{long}_normal.png: File name too long" in told.err
    assert not Path("normals").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="on Windows a link needs the rights of an administrator")
def test_a_link_to_nothing_is_named_and_the_rest_is_converted(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    draw("in/fox.png")
    Path("in/owl.png").symlink_to("gone.png")
    assert generate("in") == 1
    assert "in/owl.png is a link to gone.png, which does not exist." in capsys.readouterr().err
    assert written("normals") == {"fox_normal.png"}
    for word in ("in/owl.png", "in/o*.png"):
        assert generate(word) == 2
        assert "is a link to gone.png" in capsys.readouterr().err


def test_notes_of_a_file_system_are_no_drawings(here: Path) -> None:
    draw("in/fox.png")
    Path("in/._fox.png").write_bytes(b"\0\5\x16\7")  # of macOS, on a disk of another system
    for extra in ([], ["--recursive"]):
        assert generate("in", *extra) == 0
    assert generate("in/*.png", "in/._*", "-o", "globbed") == 1
    assert written("normals") == written("globbed") == {"fox_normal.png"}
