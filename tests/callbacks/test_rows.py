import numpy as np
import pytest
import torch

from normalgan.callbacks.rows import batch_row
from spheres import batch


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
