from typing import Literal

import pytest
import torch
import torch.nn.functional as F

from normalgan.errors import InputError
from normalgan.models.blocks import ResidualBlock, residual_blocks
from normalgan.models.condition import make_condition
from normalgan.models.residual_unet import ResidualUNetGenerator, convolve_patches, hint_pyramid

Norm = Literal["batch", "none"]


def generator(patch: int = 2, norm: Norm = "none") -> ResidualUNetGenerator:
    torch.manual_seed(0)
    return ResidualUNetGenerator((8, 12, 16), (1, 1, 1), patch, norm)


def condition(side: int = 32, count: int = 2) -> torch.Tensor:
    rng = torch.Generator().manual_seed(1)
    sketch = (torch.rand(count, 1, side, side, generator=rng) > 0.9).float()
    hints = torch.zeros(count, 4, side, side)
    hints[:, :, 5, 7] = torch.tensor([0.6, 0.0, 0.8, 1.0])
    return make_condition(sketch, hints)


def test_blocks_begin_as_the_identity() -> None:
    features = torch.randn(2, 6, 8, 8)
    torch.testing.assert_close(residual_blocks(6, 3)(features), features)


def test_norms_stand_before_every_activation_of_a_block() -> None:
    seen: list[torch.Tensor] = []
    block = ResidualBlock(6, "batch")
    block.activation.register_forward_pre_hook(lambda _, given: seen.append(given[0].detach()))
    block(100 + 50 * torch.randn(4, 6, 8, 8))
    assert len(seen) == 2
    for given in seen:
        torch.testing.assert_close(given.mean((0, 2, 3)), torch.zeros(6), atol=1e-3, rtol=0)
        torch.testing.assert_close(given.std((0, 2, 3)), torch.ones(6), atol=0.02, rtol=0)


@pytest.mark.parametrize(("norm", "same"), [("none", True), ("batch", False)])
def test_training_and_painting_differ_by_the_norms_alone(norm: Norm, same: bool) -> None:
    network = generator(norm=norm)
    trained, predicted = network.train()(condition()), network.eval()(condition())
    assert torch.allclose(trained, predicted) == same


@pytest.mark.parametrize("patch", [2, 4])
def test_deblocking_takes_the_grid_of_patches_from_smooth_forms_and_leaves_lines_sharp(patch: int) -> None:
    torch.manual_seed(0)
    plain = ResidualUNetGenerator((8, 12, 16), (1, 1, 1), patch)
    deblocked = ResidualUNetGenerator((8, 12, 16), (1, 1, 1), patch, deblock=True)
    deblocked.load_state_dict(plain.state_dict())
    sketch = torch.zeros(1, 1, 64, 64)
    sketch[..., 40] = 1
    given = make_condition(sketch, torch.zeros(1, 4, 64, 64))

    def unevenness(direction: torch.Tensor) -> float:
        return float(direction[..., 16:48, 8:32].diff(dim=3).abs().mean())

    with torch.no_grad():
        trained = deblocked.train().predict(given)
        before, after = plain.predict(given), deblocked.eval().predict(given)
    torch.testing.assert_close(trained.direction, before.direction)  # what it learns from is not averaged
    assert unevenness(after.direction) < 0.2 * unevenness(before.direction)
    torch.testing.assert_close(after.presence, before.presence, atol=0, rtol=0)
    on_line = slice(39, 42)
    torch.testing.assert_close(after.direction[..., on_line], before.direction[..., on_line])
    torch.testing.assert_close(after.direction.norm(dim=1), torch.ones(1, 64, 64))


def test_with_mirror_a_mirror_image_gets_the_mirror_image_of_the_map() -> None:
    plain = generator().eval()
    network = ResidualUNetGenerator((8, 12, 16), (1, 1, 1), 2, mirror=True).eval()
    network.load_state_dict(plain.state_dict())
    given = condition()
    flipped = given.flip(3)
    flipped[:, 0, 5, 31 - 7] = -0.6  # the hint faces the other way
    with torch.no_grad():
        before, here, there = plain.predict(given), network.predict(given), network.predict(flipped)
        trained = network.train().predict(given)
    assert here.presence is not None
    assert here.confidence is not None
    turned = here.direction.flip(3) * torch.tensor([-1.0, 1.0, 1.0])[:, None, None]
    torch.testing.assert_close(there.direction, turned)
    torch.testing.assert_close(there.presence, here.presence.flip(3))
    torch.testing.assert_close(there.confidence, here.confidence.flip(3))
    torch.testing.assert_close(here.direction.norm(dim=1), torch.ones(2, 32, 32))
    assert not torch.allclose(here.direction, before.direction)
    torch.testing.assert_close(trained.direction, before.direction)  # as fast as without, and as it learns


def test_the_hint_pyramid_keeps_the_mean_of_the_hints_of_a_cell() -> None:
    hints = torch.zeros(1, 4, 8, 8)
    hints[0, :, 0, 0] = torch.tensor([1.0, 0.0, 0.0, 1.0])
    hints[0, :, 1, 1] = torch.tensor([0.0, 0.0, 1.0, 1.0])
    hints[0, :, 7, 7] = torch.tensor([0.0, 1.0, 0.0, 1.0])
    half, quarter, eighth = hint_pyramid(hints, 3)
    assert half[0, :, 0, 0].tolist() == [0.5, 0.0, 0.5, 1.0]
    assert half[0, 3].sum() == 2
    assert quarter[0, :, 1, 1].tolist() == [0.0, 1.0, 0.0, 1.0]
    torch.testing.assert_close(
        eighth[0, :, 0, 0], torch.tensor([1, 1, 1, 3.0]) / 3 * torch.tensor([1, 1, 1, 1.0])
    )


def test_a_hint_reaches_far_pixels_from_the_start() -> None:
    """Of a fresh network, which three convolutions alone would not let a point cross."""
    given = condition(64, 1)
    given.requires_grad_()
    predicted = ResidualUNetGenerator((8,) * 5, (1,) * 5)(given)
    predicted[0, :3, 18, 24].sum().backward()  # some 20 pixels away
    assert given.grad is not None
    assert float(given.grad[0, :3, 5, 7].abs().sum()) > 0


def test_a_norm_of_a_single_value_is_refused_in_training_alone() -> None:
    network, one = generator(norm="batch"), condition(side=8, count=1)
    with pytest.raises(InputError, match=r"from one picture of 8 × 8 pixels.* use batches of 2 or more"):
        network.train()(one)
    network.eval()(one)
    network.train()(condition(side=8, count=2))


def test_sides_that_cannot_be_halved_are_refused() -> None:
    with pytest.raises(InputError, match="multiples of 8, not 36 × 36 pixels"):
        generator()(condition(36))


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (((8,), (1,), 2), "two or more levels"),
        (((8, 16), (1,), 2), "two or more levels"),
        (((8, 16), (1, 1), 3), "are 3 and 1; they must be powers of two"),
    ],
)
def test_settings_out_of_range_are_refused(
    settings: tuple[tuple[int, ...], tuple[int, ...], int], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        ResidualUNetGenerator(*settings)


def test_a_strided_convolution_is_one_of_unshuffled_patches() -> None:
    pixels, weight, bias = torch.randn(2, 5, 16, 24), torch.randn(7, 5 * 16, 3, 3), torch.randn(7)
    expected = F.conv2d(F.pixel_unshuffle(pixels, 4), weight, bias, padding=1)
    torch.testing.assert_close(convolve_patches(pixels, weight, bias, 4), expected, atol=1e-4, rtol=1e-4)


def test_detail_layers_may_see_folded_squares() -> None:
    torch.manual_seed(0)
    network = ResidualUNetGenerator((8, 12, 16), (1, 1, 1), 4, "batch", detail=2).eval()
    predicted = network(condition())
    assert predicted.shape == (2, 4, 32, 32)
    given = condition()
    given[:, 0, 17, 9] = -1  # one pixel of ink is felt where it is, not only in its square of four
    change = (network(given) - predicted).abs().sum((0, 1))
    assert change[16:18, 8:10].max() > 0
    with pytest.raises(InputError, match="are 4 and 8; they must be powers of two, and detail at most patch"):
        ResidualUNetGenerator((8, 12), (1, 1), 4, detail=8)


@pytest.mark.parametrize("patch", [1, 2, 4])
def test_every_convolution_is_given_its_own_layout(patch: int) -> None:
    """What is joined with features of another layout is copied, and the convolution copies it back."""
    network, strange = generator(patch), []

    def look(module: torch.nn.Module, given: tuple[torch.Tensor, ...]) -> None:
        if not given[0].is_contiguous(memory_format=torch.channels_last):
            strange.append(tuple(given[0].shape))

    for module in network.modules():
        if isinstance(module, torch.nn.Conv2d | torch.nn.ConvTranspose2d):
            module.register_forward_pre_hook(look)
    network(condition())
    assert strange == []


def test_hints_may_enter_with_the_sketch_alone() -> None:
    """As many weights, of which those of the levels see nothing; and a hint still changes what is painted."""
    torch.manual_seed(0)
    plain = ResidualUNetGenerator((8, 12, 16), (1, 1, 1), hint_levels=False).eval()
    torch.manual_seed(0)
    usual = ResidualUNetGenerator((8, 12, 16), (1, 1, 1)).eval()
    plain.load_state_dict(usual.state_dict())
    hinted, bare = condition(), condition()
    bare[:, 3] = 0
    with torch.no_grad():
        assert torch.equal(plain(bare), usual(bare))  # levels that see nothing are those of no hints
        assert not torch.allclose(plain(hinted), usual(hinted))
        assert not torch.allclose(plain(hinted), plain(bare))
