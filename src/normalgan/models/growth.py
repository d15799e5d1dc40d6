"""Growth: initialise a larger generator with the weights of a smaller one."""

from typing import cast

import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.models.blocks import ResidualBlock
from normalgan.models.residual_unet import ResidualUNetGenerator


@torch.no_grad()
def grow(small: ResidualUNetGenerator, large: ResidualUNetGenerator) -> None:
    """Copy the weights of a smaller generator into a larger one, in place.

    At the same resolution, the larger generator then makes exactly the same predictions. At twice the
    resolution and without hints, its prediction for a drawing enlarged 2× is the smaller generator's
    prediction for the original with each pixel repeated. New channels start at random, but the weights
    that read them start at zero, so they change nothing at first. New blocks start as the identity.

    Args:
        small: trained generator.
        large: generator with the same patch and detail sides or twice those, the same norm and the same
            number of levels. Each level has at least as many channels and blocks.

    Raises:
        InputError: if the two generators are not compatible.

    References:
        Chen, Goodfellow, Shlens 2016, "Net2Net: Accelerating Learning via Knowledge Transfer".
    """
    _check(small, large)
    scale, patch = large.patch // small.patch, small.detail_patch
    # Ink is averaged over the new pixels, and a hint is one of them.
    share = torch.tensor([1 / scale**2, 1, 1, 1, 1]).view(1, 5, 1, 1, 1, 1)
    _put(small.stem, large.stem, weight=_finer(small.stem.weight, small.patch, scale, share))
    first, last = (cast(nn.Conv2d, small.detail[index]) for index in (0, 2))
    coarse, ink_and_hints = first.weight.tensor_split(2, dim=1)
    mean = torch.tensor(1 / scale**2)
    weights = [_finer(coarse, patch, scale, mean), _finer(ink_and_hints, patch, scale, share)]
    _put(first, large.detail[0], weight=torch.cat(weights, dim=1))
    for one, other in ((last, large.detail[2]), (small.heads, large.heads)):
        weight, bias = (_repeated(values, patch, scale) for values in (one.weight, _bias(one)))
        _put(one, other, weight=weight, bias=bias)
    levels = zip([*small.encoder, *small.decoder], [*large.encoder, *large.decoder], strict=True)
    for blocks, more_blocks in levels:
        for layer, wider in zip(_layers(blocks), _layers(more_blocks), strict=False):
            _put(layer, wider)
        for block in list(more_blocks.children())[_count(blocks) :]:
            for parameter in cast(ResidualBlock, block).second.parameters():
                nn.init.zeros_(parameter)
    for up, wider in zip(small.ups, large.ups, strict=True):
        _put(up, wider)
    # Four hint channels follow the features of a level, which now has more features.
    for level, (few, many) in enumerate(zip(_widths(small)[:-1], _widths(large)[:-1], strict=True)):
        _put(small.downs[level], large.downs[level], columns=_places([few, 4], [many, 4]))
        _put(small.merges[level], large.merges[level], columns=_places([few, few, 4], [many, many, 4]))


def _put(
    small: nn.Module,
    large: nn.Module,
    weight: Tensor | None = None,
    bias: Tensor | None = None,
    columns: Tensor | None = None,
) -> None:
    """Copy a layer into the first outputs of a larger layer, which then read only the first inputs.

    Args:
        small: a convolution or a batch norm.
        large: a larger layer of the same type.
        weight: weights to use instead of those of ``small``.
        bias: bias to use instead of that of ``small``.
        columns: indices of the inputs of ``large`` that correspond to those of ``small``.
    """
    if isinstance(small, nn.BatchNorm2d):
        for name, value in small.state_dict().items():
            of_large = cast(Tensor, getattr(large, name))
            of_large.copy_(value) if value.ndim == 0 else of_large[: len(value)].copy_(value)
        return
    convolution, larger = cast(nn.Conv2d, small), cast(nn.Conv2d, large)
    source, target = (convolution.weight if weight is None else weight), larger.weight.detach()
    if isinstance(small, nn.ConvTranspose2d):  # its weights have inputs and outputs swapped
        source, target = source.transpose(0, 1), target.transpose(0, 1)
    target[: len(source)] = 0
    target[: len(source), torch.arange(source.shape[1]) if columns is None else columns] = source
    _bias(larger).detach()[: len(source)] = _bias(convolution) if bias is None else bias


def _finer(weight: Tensor, side: int, scale: int, share: Tensor) -> Tensor:
    """Return weights (O, 5 × side², k, k) spread over folded squares of ``scale`` × side."""
    out, _, *kernel = weight.shape
    squares = weight.reshape(out, 5, side, side, *kernel) * share
    return _enlarged(squares, 2, scale).reshape(out, -1, *kernel)


def _repeated(weight: Tensor, side: int, scale: int) -> Tensor:
    """Return weights (5 × side² × R, …) for outputs unfolded to squares of ``scale`` × side."""
    rest = weight.shape[1:]
    return _enlarged(weight.reshape(5, side, side, -1, *rest), 1, scale).reshape(-1, *rest)


def _enlarged(squares: Tensor, axis: int, scale: int) -> Tensor:
    return squares.repeat_interleave(scale, axis).repeat_interleave(scale, axis + 1)


def _places(counts: list[int], room: list[int]) -> Tensor:
    """Return the indices of groups of channels, each at the start of a larger slot."""
    starts = torch.tensor([0, *room]).cumsum(0)
    return torch.cat([start + torch.arange(count) for start, count in zip(starts, counts, strict=False)])


def _layers(blocks: nn.Module) -> list[nn.Module]:
    return [layer for layer in blocks.modules() if isinstance(layer, nn.Conv2d | nn.BatchNorm2d)]


def _count(blocks: nn.Module) -> int:
    return len(list(blocks.children()))


def _widths(network: ResidualUNetGenerator) -> list[int]:
    """Return the number of channels of each level."""
    ups = [cast(nn.ConvTranspose2d, up) for up in network.ups]
    return [*(up.out_channels for up in ups), ups[-1].in_channels]


def _bias(layer: nn.Conv2d) -> Tensor:
    return cast(Tensor, layer.bias)


def _check(small: ResidualUNetGenerator, large: ResidualUNetGenerator) -> None:
    levels = [[_count(level) for level in [*net.encoder, *net.decoder]] for net in (small, large)]
    widths = [_widths(net) for net in (small, large)]
    fits = small.norm == large.norm and all(
        len(few) == len(many) and all(a <= b for a, b in zip(few, many, strict=True))
        for few, many in (levels, widths)
    )
    patch, detail = small.patch, small.detail_patch
    if not fits or (large.patch, large.detail_patch) not in ((patch, detail), (2 * patch, 2 * detail)):
        raise InputError(
            "a generator grows into one of the same norm and levels, each of at least as many blocks and "
            f"channels, with a patch and detail of {patch} and {detail} or of {2 * patch} and {2 * detail}, "
            f"not {large.patch} and {large.detail_patch}."
        )
