import pytest
import torch
from torch import nn

from normalgan.errors import InputError
from normalgan.models import ResidualUNetGenerator
from normalgan.models.growth import grow


def trained(widths: tuple[int, ...], patch: int, detail: int) -> ResidualUNetGenerator:
    """Return a generator with statistics and weights that none begins with."""
    torch.manual_seed(3)
    network = ResidualUNetGenerator(widths, (1, 1, 2), patch, "batch", detail)
    for module in network.modules():
        if isinstance(module, nn.BatchNorm2d):
            nn.init.uniform_(module.running_mean, -0.3, 0.3)  # type: ignore[arg-type]
            nn.init.uniform_(module.running_var, 0.5, 2)  # type: ignore[arg-type]
    return network.eval()


@pytest.mark.parametrize(("patch", "detail"), [(2, 1), (2, 2), (1, 1)])
def test_grown_generator_paints_an_enlarged_drawing_as_before(patch: int, detail: int) -> None:
    small = trained((4, 6, 8), patch, detail)
    large = ResidualUNetGenerator((5, 9, 8), (1, 1, 2), 2 * patch, "batch", 2 * detail).eval()
    grow(small, large)
    condition = torch.zeros(2, 4, 32, 32)
    condition[:, 0] = torch.rand(2, 32, 32) * 2 - 1
    enlarged = condition.repeat_interleave(2, 2).repeat_interleave(2, 3)
    expected = small(condition).repeat_interleave(2, 2).repeat_interleave(2, 3)
    torch.testing.assert_close(large(enlarged), expected, atol=1e-5, rtol=1e-4)


def test_grown_generator_of_the_same_resolution_paints_as_before() -> None:
    small = trained((4, 6, 8), 4, 2)
    large = ResidualUNetGenerator((4, 7, 8), (1, 2, 4), 4, "batch", 2).eval()
    grow(small, large)
    condition = torch.zeros(2, 4, 32, 32)
    condition[:, 0] = torch.rand(2, 32, 32) * 2 - 1
    condition[:, :, 5, 7] = 1  # a hint
    torch.testing.assert_close(large(condition), small(condition), atol=1e-5, rtol=1e-4)


def test_blocks_that_are_new_can_learn() -> None:
    large = ResidualUNetGenerator((4, 6, 8), (1, 2, 2), 4, "batch", 2)
    grow(trained((4, 6, 8), 4, 2), large)
    large(torch.rand(2, 4, 32, 32)).square().sum().backward()
    last = large.encoder[1][1].second.weight  # type: ignore[index]
    assert last.eq(0).all()
    assert last.grad.ne(0).any()


def test_what_is_new_can_learn() -> None:
    large = ResidualUNetGenerator((5, 9, 8), (1, 1, 2), 4, "batch", 2)
    grow(trained((4, 6, 8), 2, 1), large)
    large(torch.rand(2, 4, 32, 32)).square().sum().backward()
    weight = large.heads.weight
    assert weight.grad is not None
    assert weight[:, 4:].eq(0).all()
    assert weight.grad[:, 4:].ne(0).any()


@pytest.mark.parametrize(
    "large",
    [
        ResidualUNetGenerator((4, 6, 8), (1, 1, 2), 2, "batch", 2),
        ResidualUNetGenerator((4, 6, 8), (1, 1, 2), 8, "batch", 1),
        ResidualUNetGenerator((4, 6, 8), (1, 1, 1), 4, "batch", 2),
        ResidualUNetGenerator((4, 5, 8), (1, 1, 2), 4, "batch", 2),
        ResidualUNetGenerator((4, 6, 8), (1, 1, 2), 4, "none", 2),
    ],
)
def test_others_are_refused(large: ResidualUNetGenerator) -> None:
    with pytest.raises(InputError, match="grows into one of the same norm"):
        grow(trained((4, 6, 8), 2, 1), large)
