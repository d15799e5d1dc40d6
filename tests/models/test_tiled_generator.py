import pytest
import torch

from normalgan.errors import InputError
from normalgan.models import TiledGenerator
from normalgan.models.tiled_generator import SCALES

torch.set_num_threads(1)


def small(window: int = 16) -> TiledGenerator:
    torch.manual_seed(0)
    return TiledGenerator(window, (4, 8), (1, 1)).eval()


def condition(height: int, width: int) -> torch.Tensor:
    paper = torch.ones(1, 4, height, width)
    paper[:, 3] = 0
    return paper


def test_windows_of_all_scales_have_one_middle() -> None:
    """A ramp: the mean over a window is its value at the window's middle, at every scale."""
    ramp = torch.arange(128.0).view(1, 1, 1, 128).expand(1, 1, 128, 128)
    windows = small()._windows(ramp).view(16, 16, len(SCALES), 16, 16)
    middles = windows[7:9, 7:9].mean((3, 4))  # these lie wholly within
    for column, number in ((0, 7), (1, 8)):
        torch.testing.assert_close(middles[:, column], torch.full((2, 3), 8.0 * number + 4 - 0.5))
    for channel, scale in enumerate(SCALES):
        assert windows[7, 7, channel, 8, 9] - windows[7, 7, channel, 8, 8] == scale


def test_what_all_windows_agree_on_is_laid_out_without_seams() -> None:
    generator = small()
    picture = torch.rand(2, 3, 48, 32)
    windows = [
        torch.nn.functional.unfold(picture[:, [i]], 16, stride=8, padding=4)
        .transpose(1, 2)
        .reshape(-1, 16, 16)
        for i in range(3)
    ]
    torch.testing.assert_close(generator._join(torch.stack(windows, dim=1), 48, 32), picture)


def test_it_sees_four_windows_wide_and_no_hints() -> None:
    generator = small()
    bare = condition(160, 32)
    with torch.no_grad():
        before = generator(bare)
        inked = bare.clone()
        inked[:, :3, 80, 16] = -1
        changed = ((generator(inked) - before).abs() > 1e-7).any(1)[0].any(1)
        hinted = bare.clone()
        hinted[:, :3, 80, 16] = torch.tensor([0.0, 0.6, 0.8])
        hinted[:, 3, 80, 16] = 1
        assert torch.equal(generator(hinted), before)
    rows = torch.nonzero(changed).flatten()
    reach = 2 * 16 + 8  # half of the widest window, and what overlaps
    assert 80 - reach <= rows.min() < 80 - 16
    assert 80 + 16 < rows.max() <= 80 + reach


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"window": 24}, "multiple of 16 pixels, not 24"),
        ({"widths": (4,), "blocks": (1,)}, "two or more levels"),
        ({"window": 16, "widths": (4,) * 6, "blocks": (1,) * 6}, "cannot be halved 5 times"),
    ],
)
def test_settings_that_cannot_be_used_are_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        TiledGenerator(**arguments)  # type: ignore[arg-type]


def test_sides_that_do_not_fit_are_refused() -> None:
    with pytest.raises(InputError, match="multiples of 8, not 20 × 32 pixels"):
        small()(condition(20, 32))
