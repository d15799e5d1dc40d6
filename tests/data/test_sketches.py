from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from torch.utils.data import default_collate

from normalgan.data.sketches import SketchDataset
from normalgan.errors import InputError
from normalgan.inference.jobs.plan import find_files


def draw(path: Path, width: int = 60, height: int = 40) -> Path:
    grey = np.full((height, width), 255, np.uint8)
    grey[10:30, 10:50] = 0
    grey[13:27, 13:47] = 255
    Image.fromarray(grey).save(path)
    return path


def paint_hint(path: Path, x: int = 30, y: int = 20) -> None:
    image = Image.new("RGBA", (60, 40), (0, 0, 0, 0))
    image.putpixel((x, y), (128, 128, 255, 255))
    image.save(path)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "drawings").mkdir()
    (tmp_path / "hints").mkdir()
    for name in ("cat", "dog"):
        draw(tmp_path / "drawings" / f"{name}.png")
    return tmp_path


def test_drawings_without_hints(folder: Path) -> None:
    dataset = SketchDataset(find_files(str(folder / "drawings")), 32)
    batch = default_collate([dataset[0], dataset[1]])
    assert batch["sketch"].shape == (2, 1, 32, 32)
    assert batch["sketch"].max() > 0.9
    assert batch["hints"].shape == (2, 4, 32, 32)
    assert not batch["hints"].any()
    assert batch["name"] == ["cat", "dog"]


@pytest.mark.parametrize("name", ["dog.png", "dog_hints.png"])
def test_hints_find_their_drawing(folder: Path, name: str) -> None:
    paint_hint(folder / "hints" / name)
    dataset = SketchDataset(find_files(str(folder / "drawings"), hints=str(folder / "hints")), 32)
    cat, dog = dataset[0], dataset[1]
    assert not cat["hints"].any()
    assert dog["hints"][3].sum() == 1
    assert dog["hints"][2].max() > 0.99


def test_hints_may_lie_beside_the_drawings_by_their_own_name(folder: Path) -> None:
    sketches = [str(folder / "drawings" / f"{name}.png") for name in ("cat", "dog")]
    paint_hint(folder / "drawings" / "cat_hints.png")
    dataset = SketchDataset(find_files(sketches, hints=str(folder / "drawings")), 32)
    cat, dog = dataset[0], dataset[1]
    assert cat["hints"][3].sum() == 1
    assert not dog["hints"].any()


def test_bad_drawings_are_known_at_once_and_left_out(folder: Path) -> None:
    (folder / "drawings" / "bear.png").write_text("growl")
    (folder / "drawings" / "zebra.png").write_text("stripes")
    dataset = SketchDataset(find_files(str(folder / "drawings")), 32)
    assert [dataset[i]["name"] for i in range(len(dataset))] == ["cat", "dog"]
    assert [str(each).partition(" is not an image")[0][-9:] for each in dataset.unusable] == [
        "/bear.png",
        "zebra.png",
    ]


def test_drawings_none_of_which_can_be_used_are_refused(tmp_path: Path) -> None:
    (tmp_path / "bear.png").write_text("growl")
    with pytest.raises(InputError, match=r"^\S*bear\.png is not an image"):
        SketchDataset(find_files(str(tmp_path)), 32)
    (tmp_path / "zebra.png").write_text("stripes")
    with pytest.raises(InputError, match=r"none of the 2 sketches .*; the first: .*bear\.png is not"):
        SketchDataset(find_files(str(tmp_path)), 32)


def test_hints_without_a_drawing_are_reported(folder: Path) -> None:
    with pytest.raises(InputError, match="holds no hints for any sketch"):
        SketchDataset(find_files(str(folder / "drawings"), hints=str(folder / "hints")), 32)
    with pytest.raises(InputError, match=r"no file or folder .*missing for the hints"):
        find_files(str(folder / "drawings"), hints=str(folder / "missing"))


def test_drawings_that_are_not_cached_are_prepared_again(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("normalgan.data.sketches._KEPT", 1)
    dataset = SketchDataset(find_files(str(folder / "drawings")), 32)
    assert len(dataset._kept) == 1
    whole = SketchDataset(find_files(str(folder / "drawings")), 32)
    for name in ("cat", "dog", "cat"):
        np.testing.assert_array_equal(dataset.prepared(name).model_input, whole.prepared(name).model_input)
