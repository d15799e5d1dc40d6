from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from PIL import Image

from normalgan.callbacks.gallery import MAX_ERROR, Row, batch_row, colours, draw_gallery
from normalgan.errors import InputError
from normalgan.metrics import angular_error
from spheres import batch, sphere

Picture = NDArray[np.uint8]


def make_row(size: int = 50, degrees: float = 0.0, hints: int = 0) -> Row:
    """A sphere, painted turned about the axis of view by some degrees, with hints in its middle line."""
    scene = {name: tensor.numpy() for name, tensor in sphere(size, 0.1, 0.0, 0.8).items()}
    target = scene["normal"]
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    preds = np.stack([c * target[0] - s * target[1], s * target[0] + c * target[1], target[2]])
    given = np.zeros((4, size, size), np.float32)
    columns = np.linspace(size // 4, 3 * size // 4, hints).astype(int)
    given[:3, size // 2, columns] = target[:, size // 2, columns]
    given[3, size // 2, columns] = 1
    return Row(
        "ball, view 3", scene["sketch"][0], given, preds.astype(np.float32), target, scene["mask"][0] > 0
    )


def drawn(*rows: Row) -> Picture:
    with Image.open(BytesIO(draw_gallery(rows))) as image:
        return np.asarray(image.convert("RGB"))


def cell(picture: Picture, row: int, column: int, side: int = 200) -> Picture:
    """Return a cell of a gallery, by where the layout has it."""
    top, left = 10 + 52 + row * (side + 24), 10 + column * (side + 8)
    return picture[top : top + side, left : left + side]


def test_error_is_that_of_the_metric() -> None:
    rng = np.random.default_rng(0)
    row = replace(make_row(), preds=rng.normal(size=(3, 50, 50)).astype(np.float32))
    row.preds[:, 20:25] = 0  # nothing painted
    expected = angular_error(torch.from_numpy(row.preds)[None], torch.from_numpy(row.target)[None])[0, 0]
    np.testing.assert_allclose(row.error()[row.mask], expected.numpy()[row.mask], atol=1e-3)
    assert np.isnan(row.error()[~row.mask]).all()


def test_colours_are_those_of_files_and_flat_off_the_object() -> None:
    normal = np.zeros((3, 1, 3), np.float32)
    normal[:, 0, 0], normal[:, 0, 1] = (2, 0, 0), (0.1, 0.2, 0)
    assert colours(normal)[0].tolist() == [[255, 128, 128], [128, 128, 255], [128, 128, 255]]
    on = np.array([[True, True, False]])
    assert colours(normal, on)[0, 1].tolist() == [185, 242, 128]


def test_every_pixel_of_a_map_is_a_square_of_its_colour() -> None:
    row = make_row(degrees=30)
    picture = drawn(row, row)
    assert picture.shape == (62 + 2 * 224 + 10, 20 + 5 * 200 + 4 * 8, 3)
    for line in range(2):
        for column, expected in ((2, colours(row.preds)), (3, colours(row.target, row.mask))):
            np.testing.assert_array_equal(
                cell(picture, line, column), expected.repeat(4, axis=0).repeat(4, axis=1)
            )
    inner = (slice(4, -4), slice(4, -4))  # a thin frame is drawn round the paper
    paper = np.rint((1 - row.sketch) * 255).repeat(4, axis=0).repeat(4, axis=1)
    np.testing.assert_allclose(cell(picture, 0, 0)[inner][..., 0], paper[inner], atol=1)


def test_error_map_has_the_colours_of_the_scale() -> None:
    row = make_row()
    scale = drawn(row)[38, 10 + 4 * 208 :][:200].astype(int)  # through the scale above the last column
    assert np.ptp(scale, axis=0).min() > 100
    for degrees in (5.0, 30.0, 55.0):
        flat = np.zeros((3, 50, 50), np.float32)
        flat[0], flat[2] = np.sin(np.deg2rad(degrees)), np.cos(np.deg2rad(degrees))
        target = np.zeros_like(flat)
        target[2, 10:40, 10:40] = 1
        shown = cell(drawn(replace(row, preds=flat, target=target, mask=target[2] > 0)), 0, 4)
        nearest = np.abs(scale - shown[100, 100]).sum(-1).argmin()
        assert (nearest + 0.5) / 200 * MAX_ERROR == pytest.approx(degrees, abs=0.5)
        assert np.ptp(shown[2, 2].astype(int)) == 0  # neutral grey off the object
        assert np.abs(scale - shown[2, 2]).sum(-1).min() > 60  # which no error looks like


def test_hints_are_dots_of_their_colour_on_a_faint_sketch() -> None:
    row = make_row(hints=3)
    shown = cell(drawn(row), 0, 1)
    faint = cell(drawn(replace(row, hints=np.zeros_like(row.hints))), 0, 1)
    assert faint[4:-4, 4:-4].min() > 180
    assert (faint < 250).any()
    for x in np.flatnonzero(row.hints[3, 25]):
        expected = colours(row.target, row.mask)[25, x]
        np.testing.assert_allclose(shown[25 * 4 + 2, x * 4 + 2].astype(int), expected, atol=2)
    changed = (shown != faint).any(-1)
    assert 3 * 30 < changed.sum() < 3 * 150


@pytest.mark.slow
def test_captions_say_how_many_hints_and_what_error() -> None:
    # What is written cannot be read back from pixels; that it differs where it should, can.
    def caption(row: Row, column: int) -> Picture:
        left = 10 + column * 208
        return drawn(row)[62 + 200 : 62 + 224, left : left + 200]

    row = make_row()
    assert (caption(row, 0) < 128).any()
    assert not np.array_equal(caption(row, 0), caption(replace(row, title="cow, view 3"), 0))
    assert not np.array_equal(caption(row, 1), caption(make_row(hints=1), 1))
    assert not np.array_equal(caption(row, 4), caption(make_row(degrees=20), 4))
    assert (caption(row, 2) == 255).all()


def test_empty_object_is_drawn_without_warnings() -> None:
    row = make_row()
    drawn(replace(row, mask=np.zeros_like(row.mask), target=np.zeros_like(row.target)))


def test_no_rows_are_refused() -> None:
    with pytest.raises(InputError, match="needs at least one row"):
        draw_gallery([])


def test_row_is_one_sample_in_numpy() -> None:
    given = batch(3)
    given["name"] = ["cow-0001/0", "cow-0001/1", "sub/horse/17"]
    hints = torch.zeros(3, 4, 32, 32)
    hints[2, :, 16, 16] = torch.tensor([0.0, 0.0, 1.0, 1.0])
    preds = given["normal"].bfloat16().requires_grad_()
    row = batch_row(given, 2, hints, preds)
    assert row.title == "sub/horse, view 17"
    for name in ("sketch", "hints", "preds", "target", "mask"):
        assert isinstance(getattr(row, name), np.ndarray)
    np.testing.assert_array_equal(row.target, given["normal"][2].numpy())
    np.testing.assert_array_equal(row.sketch, given["sketch"][2, 0].numpy())
    np.testing.assert_array_equal(row.mask, given["mask"][2, 0].numpy() == 1)
    assert row.preds.dtype == np.float32
    assert np.argwhere(row.hints[3]).tolist() == [[16, 16]]
    assert np.nanmean(row.error()) < 0.5


def test_row_of_a_pair_is_called_as_its_file() -> None:
    given = batch(1)
    given["name"] = ["castle/gate/0"]
    row = batch_row(given, 0, torch.zeros(1, 4, 32, 32), given["normal"], of_pairs=True)
    assert row.title == "castle/gate"


@pytest.mark.parametrize(("name", "title"), [(["ring"], "ring"), (None, "")])
def test_row_without_a_view_or_a_name(name: list[str] | None, title: str) -> None:
    given = batch(1)
    if name is not None:
        given["name"] = name
    assert batch_row(given, 0, torch.zeros(1, 4, 32, 32), given["normal"]).title == title
