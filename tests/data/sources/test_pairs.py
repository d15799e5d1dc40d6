"""Pairs on disk: how they are found, read, split and refused."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from PIL import Image

from normalgan.arrays import Floats
from normalgan.data.datamodule import MeshDataModule
from normalgan.data.loading.items import collate_decoded
from normalgan.data.settings import Split, Storage
from normalgan.data.sources import Pair, Pairs, SplitSettings
from normalgan.data.sources.pair import PairRecipe
from normalgan.data.sources.pair_files import PairFiles
from normalgan.errors import InputError
from normalgan.files.writing import write_bytes
from normalgan.metrics import angular_error
from normalgan.normals import Bits, Green, encode_exr, encode_png, paint_flat
from pairs_on_disk import SIZE, ellipsoid, hints_picture, write_pair, write_pairs

SPLITS = ("train", "val", "test")


def data(files: object, cache: Path, **settings: object) -> MeshDataModule:
    keys = ("green", "hints", "group_by", "resplit")
    of_source = {key: settings.pop(key) for key in keys if key in settings}
    defaults = {
        "size": 32,
        "cache": str(cache),
        "storage": Storage(render_workers=0),
        "batch_size": 2,
        **settings,
    }
    source = Pairs([*map(str, files)] if isinstance(files, list) else str(files), **of_source)  # type: ignore[arg-type]
    return MeshDataModule(source=source, **defaults)  # type: ignore[arg-type]


def names(module: MeshDataModule) -> dict[str, list[str]]:
    return {split: [source.name for source in module.sources[split]] for split in SPLITS}


def degrees_off(number: int, folder: Path, **settings: object) -> float:
    """Return the mean angle between a pair's sample at half its size and the truth at that size."""
    pair = Pairs(str(folder), **settings).found()[number].load()  # type: ignore[arg-type]
    sample = PairRecipe(SIZE // 2).render(pair, 0)
    normal = torch.from_numpy(sample.normal.astype(np.float32)).permute(2, 0, 1)[None]
    # The same frame as that of the sketch: its ink and the object end at the same pixels.
    truth = torch.from_numpy(PairRecipe(SIZE // 2).render(exact(number), 0).normal.astype(np.float32))
    error = angular_error(normal, truth.permute(2, 0, 1)[None])[0, 0]
    return float(error[torch.from_numpy(sample.mask)].mean())


def exact(number: int) -> Pair:
    ink, normal = ellipsoid(number)
    return Pair(1 - ink, normal)


@pytest.mark.parametrize(("bits", "most"), [(8, 0.4), (16, 0.01)])
@pytest.mark.parametrize("green", ["up", "down"])
def test_both_depths_and_both_greens_give_the_same_normals(
    tmp_path: Path, bits: Bits, most: float, green: Green
) -> None:
    write_pairs(tmp_path, 2, green, bits)
    off = degrees_off(1, tmp_path, green=green)
    assert off < most
    if bits == 8:
        assert off > 0.05  # what 8 bits lose, and 16 do not


def test_exr_in_folders_of_its_own(tmp_path: Path) -> None:
    for number in range(3):
        write_pair(
            tmp_path / "sketch" / f"{number}.png", tmp_path / "normal" / f"{number}.exr", number, "down"
        )
    assert [pair.name for pair in Pairs(str(tmp_path)).found()] == ["0", "1", "2"]
    assert degrees_off(2, tmp_path, green="down") < 0.01


def test_samples_are_made_as_drawings_are_shown_when_predicting(tmp_path: Path) -> None:
    from normalgan.inference.inputs import prepare_any

    write_pairs(tmp_path, 3)
    module = data(tmp_path, tmp_path / "cache")
    module.prepare_data()
    sample = collate_decoded([module.train_dataset[0]])
    name = sample["name"][0].removesuffix("/0")
    seen = prepare_any(tmp_path / f"{name}.png", 32).model_input
    shown = sample["sketch"][0, 0].numpy()
    np.testing.assert_array_equal(shown, np.rint(255 * seen).astype(np.float32) / 255)
    torch.testing.assert_close(sample["normal"].norm(dim=1, keepdim=True), sample["mask"])
    assert 0.3 < sample["mask"].mean() < 0.8
    assert [len(d) for d in (module.train_dataset, module.val_dataset, module.test_dataset)] == [1, 1, 1]


@pytest.mark.parametrize("layout", ["beside", "folders"])
def test_mask_and_hints_come_along(tmp_path: Path, layout: str) -> None:
    if layout == "beside":
        write_pairs(tmp_path, 3)
        mask_at, hints_at = tmp_path / "a1_mask.png", tmp_path / "a1_hints.png"
    else:
        for number in range(3):
            write_pair(
                tmp_path / "sketches" / f"a{number}.png", tmp_path / "normals" / f"a{number}.png", number
            )
        mask_at, hints_at = tmp_path / "masks" / "a1.png", tmp_path / "hints" / "a1_hints.png"
        mask_at.parent.mkdir()
        hints_at.parent.mkdir()
    mask = np.zeros((SIZE, SIZE), np.uint8)
    mask[:, : SIZE // 2] = np.where(np.abs(ellipsoid(1)[1][:, : SIZE // 2]).sum(-1) > 0, 255, 0)
    Image.fromarray(mask).save(mask_at)
    hints_picture(1).save(hints_at)
    module = data(tmp_path, tmp_path / "cache", hints=True, split=Split((1.0, 0.0, 0.0)))
    module.prepare_data()
    by_name = {module.train_dataset[i]["name"]: module.train_dataset[i] for i in range(3)}
    assert by_name["a1/0"]["mask"].sum() < 0.7 * by_name["a0/0"]["mask"].sum()
    hints = by_name["a1/0"]["hints"]
    assert by_name["a0/0"]["hints"].abs().sum() == 0
    assert hints[3].sum() == 1
    row, column = np.argwhere(hints[3].numpy() > 0)[0]
    given, there = hints[:3, row, column], by_name["a1/0"]["normal"][:, row, column]
    assert given.norm() == pytest.approx(1, abs=1e-3)
    assert float(given @ there) > 0.98
    batch = next(iter(module.train_dataloader()))
    assert batch["hints"].shape == (2, 4, 32, 32)
    plain = data(tmp_path, tmp_path / "cache", split=Split((1.0, 0.0, 0.0)))
    plain.prepare_data()
    assert "hints" not in next(iter(plain.train_dataloader()))
    assert len(list((tmp_path / "cache").glob("*/dataset.json"))) == 2


def test_a_glob_of_folders_is_split_by_folder(tmp_path: Path) -> None:
    for group in "bcdef":
        write_pairs(tmp_path / group, 3)
    module = data(
        tmp_path / "**" / "*.png", tmp_path / "cache", group_by="folder", split=Split((0.6, 0.2, 0.2))
    )
    found = names(module)
    assert {split: len(part) for split, part in found.items()} == {"train": 9, "val": 3, "test": 3}
    folders = {split: {name.split("/")[0] for name in part} for split, part in found.items()}
    assert folders["val"].isdisjoint(folders["train"] | folders["test"])
    (tmp_path / "split.json").write_text('{"train": ["b", "c"], "val": ["d"], "test": ["e", "f"]}')
    fixed = data(
        tmp_path / "**" / "*.png",
        tmp_path / "cache",
        group_by="folder",
        split=Split(file=str(tmp_path / "split.json")),
    )
    assert {name.split("/")[0] for name in names(fixed)["test"]} == {"e", "f"}
    by_file = names(data(tmp_path / "*" / "*.png", tmp_path / "cache"))
    assert sum(map(len, by_file.values())) == 15


def test_files_that_operating_systems_leave_are_ignored(tmp_path: Path) -> None:
    write_pairs(tmp_path, 3)
    for name in ("._0.png", "._0_normal.png", "._9_normal.png", "Thumbs.db", "desktop.ini", ".DS_Store"):
        (tmp_path / name).write_bytes(b"\0\5\x16\7")
    found = [pair.name for pair in Pairs(str(tmp_path)).found()]
    assert len(found) == 3
    assert not any(name.startswith(".") for name in found)


def test_a_csv_lists_pairs_their_groups_and_their_splits(tmp_path: Path) -> None:
    write_pairs(tmp_path / "in", 4)
    rows = ["sketch, normal, group", *(f"in/a{i}.png, in/a{i}_normal.png, {'xyzx'[i]}" for i in range(4))]
    (tmp_path / "pairs.csv").write_text("\n".join(rows))
    found = names(data(tmp_path / "pairs.csv", tmp_path / "cache", split=Split((0.4, 0.3, 0.3))))
    assert sorted(name for part in found.values() for name in part) == [f"in/a{i}" for i in range(4)]
    (side,) = (split for split, part in found.items() if "in/a0" in part)
    assert "in/a3" in found[side]
    rows = ["name,sketch,normal,split", *(f"p{i},in/a{i}.png,in/a{i}_normal.png,train" for i in range(3))]
    (tmp_path / "told.csv").write_text("\n".join([*rows, "p3,in/a3.png,in/a3_normal.png,test"]))
    assert names(data(tmp_path / "told.csv", tmp_path / "cache")) == {
        "train": ["p0", "p1", "p2"],
        "val": [],
        "test": ["p3"],
    }


def remove_normal(folder: Path) -> None:
    (folder / "a1_normal.png").unlink()


def remove_sketch(folder: Path) -> None:
    (folder / "a1.png").unlink()


def remove_all(folder: Path) -> None:
    for path in folder.iterdir():
        path.unlink()


def put_in_folders(folder: Path) -> None:
    for path in list(folder.glob("*.png")):
        (folder / path.name[:2]).mkdir(exist_ok=True)
        path.rename(folder / path.name[:2] / path.name)


def add_twin(folder: Path) -> None:
    Image.open(folder / "a1.png").save(folder / "a1.bmp")


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (remove_all, r"an empty folder is at .*; a pair is"),
        (
            put_in_folders,
            r"no sketch is at (.*); a pair .*; those in folders below it are .* '\1/\*\*/\*\.png'\.$",
        ),
        (add_twin, r"two pairs are named a1: .*a1\.bmp and .*a1\.png; rename one"),
    ],
)
def test_a_folder_that_cannot_be_used(tmp_path: Path, spoil: Callable[[Path], None], sentence: str) -> None:
    write_pairs(tmp_path, 3)
    spoil(tmp_path)
    with pytest.raises(InputError, match=sentence):
        Pairs(str(tmp_path)).found()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "sketch,normals\na0.png,a0_normal.png",
            r"has a column 'normals', which is unknown\. Did you mean normal\? Its first line names",
        ),
        (
            "sketch,mask\na0.png,a0.png",
            "has no column 'normal'; its first line names columns, sketch, normal",
        ),
        (
            "sketch,normal\na0.png,gone.png",
            r"line 2 of .*names gone\.png as normal, and there is no file [^;]*gone\.png\.$",
        ),
        ("sketch,normal\na0.png,", "line 2 of .* names no normal; a pair has both"),
        ("sketch,normal\na0.png", "line 2 of .* does not have as many values as there are columns, 2"),
        ("sketch,normal\n", "lists no pair; each line after the first is one"),
        ("sketch,normal,split\na0.png,a0_normal.png,dev", "has the split 'dev'; it is train, val, test"),
        (
            "sketch,normal,split\na0.png,a0_normal.png,val\na1.png,a1_normal.png,",
            r"a1\.png has no split, but others do",
        ),
        (
            "sketch,normal,split,group\na0.png,a0_normal.png,val,g\na1.png,a1_normal.png,test,g",
            "the group g is in val and in test; a group belongs to one split",
        ),
    ],
)
def test_a_csv_that_cannot_be_used(tmp_path: Path, text: str, sentence: str) -> None:
    write_pairs(tmp_path, 2)
    (tmp_path / "pairs.csv").write_text(text)
    with pytest.raises(InputError, match=sentence):
        Pairs(str(tmp_path / "pairs.csv")).found()


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"group_by": "name"}, "group_by of Pairs is 'name'; it must be 'file' or 'folder'"),
        ({"files": 3}, r"files=3; name a folder, a glob of sketches, a CSV, or a list of these\.$"),
        ({"files": ["pairs", None]}, r"files=\['pairs', None\]; name a folder, a glob of sketches"),
    ],
)
def test_settings_are_checked(given: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        Pairs(**{"files": "pairs", **given})


def test_settings_of_meshes_do_not_go_with_a_source(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"data\.meshes says that the data are meshes, and data\.source names"
    ):
        MeshDataModule("meshes", source=Pairs("pairs"))
    with pytest.raises(InputError, match=r"data\.on_the_fly renders meshes .*, but Pairs has pairs"):
        MeshDataModule(source=Pairs("pairs"), on_the_fly=True)
    write_pairs(tmp_path, 2)
    with pytest.raises(InputError, match="2 pairs cannot be split in 3 parts; add pairs or set a fraction"):
        Pairs(str(tmp_path)).split(SplitSettings())


WHITE = np.ones((SIZE, SIZE), np.float32)
FLAT = np.zeros((SIZE, SIZE, 3), np.float32)
FLAT[8:-8, 8:-8, 2] = 1


def infinite_at_a_pixel(array: NDArray[np.float32]) -> NDArray[np.float32]:
    spoilt = array.copy()
    spoilt[SIZE // 2, SIZE // 2] = np.inf
    return spoilt


@pytest.mark.parametrize(
    ("sketch", "normal", "sentence"),
    [
        (WHITE, FLAT.tolist(), "the normal map is of the type list; it is an array of floats with the shape"),
        (WHITE, FLAT[..., 2], rf"an array of float32 with the shape \({SIZE}, {SIZE}\); it is an array of"),
        (WHITE, FLAT.transpose(2, 0, 1), rf"float32 with the shape \(3, {SIZE}, {SIZE}\); it is an array of"),
        (
            WHITE,
            ((FLAT + 1) * 127.5).astype(np.uint8),
            r"an array of uint8 with the shape .*; it is an array of floats .* become vectors by normalgan",
        ),
        (
            WHITE,
            (FLAT + 1) / 2,
            r"holds colours from 0 to 1, not vectors from -1 to 1; normalgan\.normals\.vec",
        ),
        (WHITE, FLAT * 255, "the normal map holds no normals: its vectors are 255.00 long at the median"),
        (WHITE, infinite_at_a_pixel(FLAT), "the normal map holds numbers that are not finite"),
        (WHITE, FLAT * 0, "the normal map has no object: all its vectors are zero"),
        (WHITE, FLAT[:-1], f"the sketch has {SIZE} × {SIZE} pixels and its normal map {SIZE} × {SIZE - 1}"),
        (WHITE * 255, FLAT, "the image has floats from 255 to 255; black is 0 and white is 1"),
        (WHITE.astype(int), FLAT, "the image is an array of int64; give uint8 from 0 to 255, uint16"),
        (WHITE.tolist(), FLAT, "the image is of the type list; give a path, an array or an image of Pillow"),
    ],
)
def test_an_array_of_a_wrong_type_or_range_is_one_sentence(sketch: Any, normal: Any, sentence: str) -> None:
    Pair(WHITE, FLAT)  # as it is right
    with pytest.raises(InputError, match=sentence) as caught:
        Pair(sketch, normal)
    assert "\n" not in str(caught.value)


def test_a_run_resumed_with_another_order_of_pairs_says_so(tmp_path: Path) -> None:
    write_pairs(tmp_path / "pairs", 4)
    first, other = (data(tmp_path / "pairs", tmp_path / "cache", seed=seed) for seed in (0, 1))
    for module in (first, other):
        module.setup("fit")
    first.load_state_dict(first.state_dict())
    with pytest.warns(UserWarning, match=r"continues with the current settings: .*data\.seed \(0, now 1\)"):
        other.load_state_dict(first.state_dict())


@pytest.mark.parametrize("nothing", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("vectors", [True, False], ids=["vectors", "colours"])
@pytest.mark.parametrize("masked", [True, False], ids=["mask", "no mask"])
def test_numbers_that_are_not_finite_off_the_object_are_background(
    tmp_path: Path, nothing: float, vectors: bool, masked: bool
) -> None:
    write_pairs(tmp_path, 2)
    _, normal = ellipsoid(1)
    there = np.abs(normal).sum(-1) > 0
    held = np.where(there[..., None], normal, nothing).astype(np.float32)
    write_bytes(tmp_path / "n.exr", encode_exr(held * 2 - 1 if vectors else held))  # it stores (n + 1) / 2
    mask = None
    if masked:
        mask = tmp_path / "m.png"
        Image.fromarray(there).save(mask)
    pair = PairFiles("a", tmp_path / "a1.png", tmp_path / "n.exr", mask).load()
    np.testing.assert_array_equal(pair.mask, there)
    np.testing.assert_allclose(pair.normal, normal, atol=1e-5)


def test_an_svg_has_the_size_of_its_normal_map(tmp_path: Path) -> None:
    write_pairs(tmp_path, 1)
    ring = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 8 8">{RING}</svg>'
    (tmp_path / "a.svg").write_text(ring)
    pair = PairFiles("a", tmp_path / "a.svg", tmp_path / "a0_normal.png").load()
    assert pair.sketch.shape == pair.mask.shape == (SIZE, SIZE)
    assert PairRecipe(32).render(pair, 0).sketch.max() > 200
    (tmp_path / "long.svg").write_text(ring.replace("0 0 8 8", "0 0 300 8"))
    long = np.zeros((80, 3000, 3), np.float32)  # longer than what a picture is reduced to
    long[..., 2] = 1
    long[:9] = long[-9:] = 0
    write_bytes(tmp_path / "long.png", encode_png(long))
    assert PairFiles("a", tmp_path / "long.svg", tmp_path / "long.png").load().mask.shape == (80, 3000)


RING = '<circle cx="4" cy="4" r="2" fill="none" stroke="black" stroke-width=".2"/>'


def test_a_list_that_is_no_table_is_told(tmp_path: Path) -> None:
    (tmp_path / "pairs.txt").write_text("sketch,normal")
    with pytest.raises(
        InputError, match=r"pairs\.txt is neither a picture nor a list of pairs \(\.csv, \.tsv\);"
    ):
        Pairs(str(tmp_path / "pairs.txt")).found()


def make_smaller(folder: Path) -> None:
    write_pair(folder / "x.png", folder / "a1_normal.png", 1, size=32)
    (folder / "x.png").unlink()


def make_photo(folder: Path) -> None:
    grey = np.random.default_rng(0).integers(90, 190, (SIZE, SIZE, 3), dtype=np.uint8)
    Image.fromarray(grey).save(folder / "a1_normal.png")


def make_grey(folder: Path) -> None:
    Image.fromarray(np.full((SIZE, SIZE), 128, np.uint8)).save(folder / "a1_normal.png")


def flip_green_of(folder: Path) -> None:
    write_pair(folder / "a1.png", folder / "a1_normal.png", 1, green="down")


def turn_to_the_world(folder: Path) -> None:
    _, normal = ellipsoid(1)
    write_bytes(folder / "a1_normal.png", encode_png(normal[..., [2, 1, 0]]))


def give_a_hint_off_the_object(folder: Path) -> None:
    dots = np.zeros((SIZE, SIZE, 4), np.uint8)
    dots[1, 2] = (128, 128, 255, 255)
    Image.fromarray(dots).save(folder / "a1_hints.png")


def make_flat(folder: Path) -> None:
    Image.new("RGB", (SIZE, SIZE), (128, 128, 255)).save(folder / "a1_normal.png")


def break_file(folder: Path) -> None:
    break_file_of(folder, "a1")


def break_file_of(folder: Path, name: str) -> None:
    (folder / f"{name}_normal.png").write_bytes(b"\x89PNG nothing")


def erase_sketch(folder: Path) -> None:
    Image.new("L", (SIZE, SIZE), 255).save(folder / "a1.png")


def test_a_source_of_pairs_that_loads_something_else_is_told() -> None:
    with pytest.raises(
        InputError, match=r"^its load gave NoneType; a source of pairs loads a normalgan\.data"
    ):
        PairRecipe(32).render(None, 0)  # type: ignore[arg-type]


def flip_red_of(folder: Path) -> None:
    repaint(folder, lambda vectors: vectors * np.array([-1, 1, 1], np.float32))


def exchange_red_and_green_of(folder: Path) -> None:
    repaint(folder, lambda vectors: vectors[..., [1, 0, 2]])


def turn_a_quarter(folder: Path) -> None:
    repaint(folder, lambda vectors: vectors[..., [1, 0, 2]] * np.array([-1, 1, 1], np.float32))


def repaint(folder: Path, change: Callable[[Floats], Floats]) -> None:
    """Write the normal map of ``a1`` again, with other vectors on the object."""
    _, vectors = ellipsoid(1)
    mask = np.abs(vectors).sum(-1) > 0
    write_bytes(folder / "a1_normal.png", encode_png(paint_flat(change(vectors), mask)))


def invert_a_mask(folder: Path) -> None:
    _, vectors = ellipsoid(1)
    background = (np.abs(vectors).sum(-1) == 0).astype(np.uint8)
    Image.fromarray(255 * background).save(folder / "a1_mask.png")


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (make_smaller, "the sketch has 64 × 64 pixels and its normal map 32 × 32; both must show the same"),
        (
            make_photo,
            r"the normal map holds no normals: its vectors are 0\.\d\d long at the median, and \d+% of them",
        ),
        (make_grey, "is grey; a normal map needs three channels"),
        (flip_green_of, "looks as if its green had the opposite direction: .* set green to down"),
        (flip_red_of, "looks as if its red had the opposite direction: .* invert its red"),
        (exchange_red_and_green_of, "looks as if its red and green were exchanged: .* exchange them"),
        (turn_a_quarter, "looks as if its red and green were exchanged: .* exchange them"),
        (
            invert_a_mask,
            "the mask covers the background of the normal map, not its object; paint the object white",
        ),
        (turn_to_the_world, r"point away from the viewer \(\d+% on the object have z below 0\)"),
        (make_flat, "shows nothing but its background"),
        (break_file, "cannot be read as an image: it starts like a PNG but is truncated or damaged"),
        (give_a_hint_off_the_object, "the hint at x 2, y 1 is outside the object"),
        (erase_sketch, "no lines were found in it"),
    ],
)
def test_a_bad_pair_is_left_out_and_named_and_alone_it_stops_the_run(
    tmp_path: Path, spoil: Callable[[Path], None], sentence: str
) -> None:
    write_pairs(tmp_path, 4)
    spoil(tmp_path)
    splits = '{"train": ["a0", "a1"], "val": ["a2"], "test": ["a3"]}'
    (tmp_path / "split.json").write_text(splits)
    hints = spoil is give_a_hint_off_the_object
    module = data(tmp_path, tmp_path / "cache", split=Split(file=str(tmp_path / "split.json")), hints=hints)
    with pytest.warns(UserWarning, match=f"(the pair a1|1 file) is left out: .*{sentence}"):
        module.prepare_data()
    assert {module.train_dataset[i]["name"] for i in range(len(module.train_dataset))} == {"a0/0"}
    (tmp_path / "split.json").write_text(splits.replace('["a0", "a1"]', '["a1"]').replace('"a2"', '"a0"'))
    alone = data(tmp_path, tmp_path / "other", split=Split(file=str(tmp_path / "split.json")), hints=hints)
    with (
        pytest.warns(UserWarning, match=re.escape("does not name")),
        pytest.raises(InputError, match=f"(?s)the only pair for train .*: .*{sentence}"),
    ):
        alone.prepare_data()


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (remove_normal, r"1 file is left out: .*a1\.png has no normal map\.$"),
        (remove_sketch, r"1 file is left out: .*a1_normal\.png has no sketch\.$"),
    ],
)
def test_a_file_without_its_partner_is_left_out_in_one_list(
    tmp_path: Path, spoil: Callable[[Path], None], sentence: str
) -> None:
    write_pairs(tmp_path, 3)
    spoil(tmp_path)
    with pytest.warns(UserWarning, match=sentence):
        assert [pair.name for pair in Pairs(str(tmp_path)).found()] == ["a0", "a2"]
    for path in tmp_path.glob("a[02]_normal.png"):
        path.unlink()
    with pytest.raises(InputError, match=r"; a pair is .*A/a\.png with B/a\.png"):
        Pairs(str(tmp_path)).found()


def test_damaged_files_are_reported_in_one_list_and_do_not_change_the_split(tmp_path: Path) -> None:
    write_pairs(tmp_path, 8)
    rows = [f"a{i}.png,a{i}_normal.png" for i in range(8)]
    (tmp_path / "pairs.csv").write_text("\n".join(["sketch,normal", *rows]))
    whole = names(data(tmp_path / "pairs.csv", tmp_path / "cache"))
    spoilt = next(name for name in whole["train"] if name != "a0")
    break_file_of(tmp_path, spoilt)
    rows.append("gone.png,a0_normal.png")
    (tmp_path / "pairs.csv").write_text("\n".join(["sketch,normal", *rows]))
    listed = rf"2 files are left out: line 10 of .*names gone\.png as sketch.*; .*{spoilt}_normal\.png cannot"
    with pytest.warns(UserWarning, match=listed):
        found = names(data(tmp_path / "pairs.csv", tmp_path / "cache"))
    assert found == {split: [name for name in part if name != spoilt] for split, part in whole.items()}


@pytest.mark.parametrize("layout", ["AB", "bare", "A and B"])
def test_folders_of_pix2pix_are_read_as_they_are(tmp_path: Path, layout: str) -> None:
    for part, count in (("train", 2), ("val", 1), ("test", 1)):
        for number in range(count):
            if layout == "A and B":
                write_pair(
                    tmp_path / "A" / part / f"{number}.png", tmp_path / "B" / part / f"{number}.png", 1
                )
                continue
            write_pair(tmp_path / "a.png", tmp_path / "b.png", 1)
            halves = [np.asarray(Image.open(tmp_path / f"{half}.png").convert("RGB")) for half in "ab"]
            folder = tmp_path / "pairs" / ("AB" if layout == "AB" else "") / part
            folder.mkdir(parents=True, exist_ok=True)
            Image.fromarray(np.hstack(halves)).save(folder / f"{number}.png")
    module = data(tmp_path if layout == "A and B" else tmp_path / "pairs", tmp_path / "cache")
    assert names(module) == {"train": ["train/0", "train/1"], "val": ["val/0"], "test": ["test/0"]}
    write_pair(tmp_path / "plain" / "a.png", tmp_path / "plain" / "a_normal.png", 1)
    (plain,) = Pairs(str(tmp_path / "plain")).found()
    pair, other = module.sources["val"][0].load(), plain.load()
    np.testing.assert_array_equal(pair.normal, other.normal)
    assert pair.sketch.shape == other.sketch.shape == (SIZE, SIZE)


@pytest.mark.parametrize("layout", ["sketch and normal", "beside", "trainA and trainB"])
def test_folders_of_splits_hold_pairs_of_any_layout(tmp_path: Path, layout: str) -> None:
    for number, part in enumerate(SPLITS):
        sketch, normal = {
            "sketch and normal": (f"{part}/sketch/{number}.png", f"{part}/normal/{number}.png"),
            "beside": (f"{part}/{number}.png", f"{part}/{number}_normal.png"),
            "trainA and trainB": (f"{part}A/{number}.png", f"{part}B/{number}.png"),
        }[layout]
        write_pair(tmp_path / sketch, tmp_path / normal, number)
    module = data(tmp_path, tmp_path / "cache")
    assert names(module) == {part: [f"{part}/{number}"] for number, part in enumerate(SPLITS)}
    np.testing.assert_allclose(module.sources["val"][0].load().normal, exact(1).normal, atol=0.03)


@pytest.mark.parametrize(
    ("entry", "sentence"),
    [
        ("gone", "there is no file or folder .*gone; a pair is a.png"),
        ("A", r"no sketch is at .*A; a pair .*; name the folder that holds A and B, [^*]*\.$"),
    ],
)
def test_a_message_about_a_folder_names_what_works(tmp_path: Path, entry: str, sentence: str) -> None:
    write_pair(tmp_path / "A" / "train" / "0.png", tmp_path / "B" / "train" / "0.png", 0)
    with pytest.raises(InputError, match=sentence):
        Pairs(str(tmp_path / entry)).found()


def test_hints_that_no_pair_has_are_not_used_in_silence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"hints of Pairs is true, but no pair has hints.* add them, or set"):
        Pairs(str(write_pairs(tmp_path, 3)), hints=True).found()


def write_double(path: Path, number: int, flipped: bool = False, columns: int = 2 * SIZE) -> None:
    """Write a sketch and its normal map side by side into one picture."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_pair(path.with_name("a.png"), path.with_name("b.png"), number)
    halves = [np.asarray(Image.open(path.with_name(f"{half}.png")).convert("RGB")) for half in "ab"]
    for half in "ab":
        path.with_name(f"{half}.png").unlink()
    Image.fromarray(np.hstack(halves[::-1] if flipped else halves)[:, :columns]).save(path)


@pytest.mark.parametrize("layout", ["AB", "A and B"])
def test_the_other_direction_of_pix2pix_is_named_and_can_be_set(tmp_path: Path, layout: str) -> None:
    for number in range(3):
        if layout == "AB":
            write_double(tmp_path / "AB" / f"{number}.png", number, flipped=True)
        else:
            write_pair(tmp_path / "B" / f"{number}.png", tmp_path / "A" / f"{number}.png", number)
    (wrong, *_), (right, *_) = (Pairs(str(tmp_path), direction=way).found() for way in ("AtoB", "BtoA"))
    what = "shows the normal map where the sketch" if layout == "AB" else "is a normal map, and .* a sketch"
    with pytest.raises(InputError, match=f"0.png {what}.*direction BtoA"):
        wrong.load()
    np.testing.assert_allclose(right.load().normal, exact(0).normal, atol=0.03)
    assert wrong.fingerprint() != right.fingerprint()


@pytest.mark.parametrize("layout", ["AB", "BA", "A and B"])
@pytest.mark.parametrize("ending", ["jpg", "webp"])
def test_a_lossy_normal_map_has_the_object_of_the_lossless_one(
    tmp_path: Path, layout: str, ending: str
) -> None:
    # JPEG changes the colour of the background around each line, and over the seam of the two halves.
    path = tmp_path / "lossy" / f"a_normal.{ending}"
    write_pair(path.with_name("a.png"), tmp_path / "exact.png", 1, size=256)
    halves = [Image.open(each).convert("RGB") for each in (path.with_name("a.png"), tmp_path / "exact.png")]
    if layout == "A and B":
        halves[1].save(path, quality=75)
    else:
        both = np.hstack([np.asarray(half) for half in (halves[::-1] if layout == "BA" else halves)])
        (tmp_path / "double" / "AB").mkdir(parents=True)
        Image.fromarray(both).save(tmp_path / "double" / "AB" / f"a.{ending}", quality=75)
    folder = path.parent if layout == "A and B" else tmp_path / "double"
    (pair,) = Pairs(str(folder), direction="BtoA" if layout == "BA" else "AtoB").found()
    truth = np.abs(ellipsoid(1, 256)[1]).sum(-1) > 0
    mask = pair.load().mask
    assert (mask & truth).sum() / (mask | truth).sum() > 0.95


def test_side_by_side_pictures_of_other_shapes_are_halved_or_named(tmp_path: Path) -> None:
    for number in range(3):
        write_double(tmp_path / "AB" / "train" / f"{number}.png", number, columns=2 * SIZE - (number == 0))
    folder = tmp_path / "AB" / "train"
    Image.open(folder / "2.png").crop((0, 8, 2 * SIZE, SIZE - 8)).save(folder / "2.png")
    with pytest.warns(UserWarning, match=r"0\.png is 127 pixels wide, which has no half"):
        found = Pairs(str(tmp_path)).found()
    assert [pair.name for pair in found] == ["train/1", "train/2"]
    assert found[1].load().sketch.shape == (SIZE - 16, SIZE)
    Image.open(folder / "1.png").crop((0, 0, 100, SIZE)).save(folder / "1.png")
    with pytest.raises(InputError, match=r"^the right half of .*1\.png: the normal map holds"):
        found[0].load()
    # Without a folder AB, one picture that is twice as wide as high shows what they are.
    write_double(folder / "3.png", 3)
    folder.rename(tmp_path / "train")
    (tmp_path / "AB").rmdir()
    with pytest.warns(UserWarning, match="which has no half"):
        assert len(Pairs(str(tmp_path)).found()) == 3


def test_splits_given_by_folders_can_be_replaced(tmp_path: Path) -> None:
    for number in range(6):
        write_double(tmp_path / "AB" / ("train" if number < 4 else "test") / f"{number}.png", number)
    with pytest.raises(InputError, match=r"split val is empty.*put pairs into val there, or .*resplit true"):
        data(tmp_path, tmp_path / "cache").val_dataset  # noqa: B018
    with pytest.raises(InputError, match=r"^data\.split\.file is s\.json, but .*resplit true"):
        data(tmp_path, tmp_path / "cache", split=Split(file="s.json")).sources  # noqa: B018
    found = names(data(tmp_path, tmp_path / "cache", resplit=True))
    assert {part: len(of) for part, of in found.items()} == {"train": 4, "val": 1, "test": 1}


def test_a_hole_is_background_where_the_file_can_say_so(tmp_path: Path) -> None:
    _, normal = ellipsoid(1)
    hole = np.zeros((SIZE, SIZE), np.bool_)
    hole[28:36, 28:36] = True
    mask = (np.abs(normal).sum(-1) > 0) & ~hole
    zero = np.where(mask[..., None], normal, np.float32(0))
    write_pair(tmp_path / "a.png", tmp_path / "a_normal.png", 1)
    flat = paint_flat(zero, mask)
    write_bytes(tmp_path / "zero.exr", encode_exr(zero))
    write_bytes(tmp_path / "opaque.exr", encode_exr(zero, np.ones((SIZE, SIZE), np.float32)))
    write_bytes(tmp_path / "grey.png", encode_png(zero))
    write_bytes(tmp_path / "cut.png", encode_png(flat, alpha=mask.astype(np.float32)))
    ground = zero.copy()  # flat, and the hole is zero
    ground[~(mask | hole)] = (0, 0, 1)
    write_bytes(tmp_path / "ground.exr", encode_exr(ground))
    for name in ("zero.exr", "opaque.exr", "grey.png", "cut.png", "ground.exr"):
        pair = PairFiles("a", tmp_path / "a.png", tmp_path / name).load()
        np.testing.assert_array_equal(pair.mask, mask, err_msg=name)


def test_a_bowl_seen_from_above_is_not_refused_for_its_directions() -> None:
    ink, vectors = ellipsoid(1)
    bowl = vectors * np.array([-1, -1, 1], np.float32)
    assert np.allclose(Pair(1 - ink, bowl).normal, bowl, atol=1e-6)


@pytest.mark.parametrize(
    ("sketch", "normal"),
    [
        ("A.PNG", "A_normal.PNG"),
        ("Sketch/1.png", "Normal/1.png"),
        ("SKETCHES/1.PNG", "NORMALS/1.PNG"),
        ("normals/1.png", "normals/1_normal.png"),  # a folder that only has the name of a partner's
    ],
)
def test_capitals_and_the_name_of_the_folder_do_not_matter(tmp_path: Path, sketch: str, normal: str) -> None:
    write_pair(tmp_path / sketch, tmp_path / normal, 0)
    folder = tmp_path / "normals" if sketch.startswith("normals/") else tmp_path
    found = Pairs(str(folder)).found()
    assert [(pair.sketch, pair.normal) for pair in found] == [(tmp_path / sketch, tmp_path / normal)]


@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_a_csv_may_be_separated_as_spreadsheets_do(tmp_path: Path, delimiter: str) -> None:
    write_pair(tmp_path / "a,1.png", tmp_path / "a_normal.png", 0)
    lines = (["sketch", "normal", "split"], ["a,1.png", "a_normal.png", "train"])
    for name in ("pairs.csv", "pairs.tsv"):
        (tmp_path / name).write_text("\n".join(delimiter.join(line) for line in lines))
        (found,) = Pairs(str(tmp_path / name)).found()
        assert (found.sketch, found.part) == (tmp_path / "a,1.png", "train")
