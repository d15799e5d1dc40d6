import pytest
import torch

from normalgan.errors import InputError
from normalgan.models import (
    Discriminator,
    Generator,
    GlobalDiscriminator,
    PatchDiscriminator,
    UNetDiscriminator,
    UNetGenerator,
)


def parameters(network: torch.nn.Module) -> int:
    return sum(p.numel() for p in network.parameters())


@pytest.mark.parametrize(
    ("build", "count"),
    [
        (UNetGenerator, 54_414_979),  # unet_256 of pix2pix, 4 channels in
        # Su et al.'s own network, but for the scale and shift of the norm at its innermost layer
        (lambda: UNetGenerator(kernel=5, bias=True), 85_024_387 - 2 * 512),
        (UNetDiscriminator, 54_412_929),
        (lambda: UNetDiscriminator(see_mask=True), 54_413_953),
        (PatchDiscriminator, 2_768_705),
        (lambda: PatchDiscriminator(see_mask=True), 2_769_729),
        (GlobalDiscriminator, 4_837_441),
    ],
)
def test_parameter_counts_are_the_published_ones(build: type[torch.nn.Module], count: int) -> None:
    with torch.device("meta"):  # counts need no memory
        assert parameters(build()) == count


def test_every_input_pixel_reaches_every_output_pixel() -> None:
    torch.manual_seed(0)  # other weights may leave a path whose every ReLU is off
    generator = UNetGenerator(size=32, width=4, norm="none").eval()
    x = torch.randn(1, 4, 32, 32, requires_grad=True)
    generator(x)[0, :, 0, 0].sum().backward()
    assert x.grad is not None
    assert (x.grad[0, :, 31, 31] != 0).any()


def test_noise_is_dropout_on_in_training_only() -> None:
    generator = UNetGenerator(size=64, width=4)
    x = torch.randn(2, 4, 64, 64)
    assert not torch.equal(generator(x), generator(x))
    generator.eval()
    assert torch.equal(generator(x), generator(x))


@pytest.mark.parametrize(
    ("critic", "shapes"),
    [
        (UNetDiscriminator(size=32, width=4), [(2, 1, 32, 32)]),
        (UNetDiscriminator(size=32, width=4, encoder_head=True), [(2, 1, 32, 32), (2, 1)]),
        (PatchDiscriminator(width=4, layers=2), [(2, 1, 6, 6)]),
        (GlobalDiscriminator(size=32, width=4), [(2, 1)]),
    ],
)
def test_discriminator_heads(critic: Discriminator, shapes: list[tuple[int, ...]]) -> None:
    condition, normal = torch.randn(2, 4, 32, 32), torch.randn(2, 3, 32, 32)
    assert [tuple(score.shape) for score in critic(condition, normal)] == shapes


def test_patch_of_three_layers_sees_70_pixels() -> None:
    critic = PatchDiscriminator(width=2, norm="none")
    normal = torch.zeros(1, 3, 256, 256, requires_grad=True)
    (score,) = critic(torch.zeros(1, 4, 256, 256), normal)
    assert score.shape == (1, 1, 30, 30)
    score[0, 0, 15, 15].backward()
    assert normal.grad is not None
    seen = normal.grad[0].abs().sum(0).nonzero()
    assert (seen.amax(0) - seen.amin(0) + 1).tolist() == [70, 70]


def test_wrong_sizes_are_said() -> None:
    with pytest.raises(InputError, match="power of two, at least 4, not 100"):
        UNetGenerator(size=100)
    with pytest.raises(InputError, match="multiples of 64, not 32 × 96"):
        UNetGenerator(size=64, width=2)(torch.zeros(1, 4, 32, 96))
    with pytest.raises(InputError, match="built for 32 × 32 pixels, not 64 × 64"):
        GlobalDiscriminator(size=32, width=2)(torch.zeros(1, 4, 64, 64), torch.zeros(1, 3, 64, 64))
    with pytest.raises(InputError, match="multiple of 8"):
        GlobalDiscriminator(size=20)


class CopiedForward(Generator):
    """Has the `forward` of `ResidualUNetGenerator` and not its `predict`."""

    def forward(self, condition: torch.Tensor) -> torch.Tensor:
        return self.predict(condition).channels()


def test_a_generator_whose_forward_calls_the_default_predict_is_refused_and_not_stuck() -> None:
    generator = CopiedForward()
    for _ in range(2):  # nothing is left behind by the first call
        with pytest.raises(InputError, match=r"^CopiedForward\.forward calls predict, .*; override predict"):
            generator(torch.zeros(1, 4, 32, 32))
