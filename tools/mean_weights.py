"""Makes the weighted mean of two trainings of one network: tools/mean_weights.py ONE OTHER OUT --share 0.5.

ONE and OTHER are safetensors of `normalgan export`, or ``shipped``; OUT is such a file, with the notes of
OTHER, in 32 bits; SHARE is how much OTHER counts. Of a network and its further training the mean is often
better than both, as errors that they do not share shrink (Wortsman et al. 2022, "Model soups"). ONE may be
the smaller network that OTHER was grown from.
"""

import argparse
from pathlib import Path

from normalgan.errors import InputError
from normalgan.files.writing import write_bytes
from normalgan.models import ResidualUNetGenerator
from normalgan.models.growth import grow
from normalgan.weights.file import Weights, find_weights, read_weights


def mean_weights(one: Weights, other: Weights, share: float) -> Weights:
    """Return weights between two of one network, statistics of norms among them, in 32 bits.

    Args:
        one: counts 1 - ``share``; of the same network or of a smaller one that the other has grown from.
        other: counts ``share``; its notes are kept.
        share: 0 to 1.

    Raises:
        InputError: if they are of different networks, or the share is none.
    """
    if not 0 <= share <= 1:
        raise InputError(f"the share is {share}; give 0 to 1.")
    one = _grown(one, other)
    if _shapes(one) != _shapes(other):
        raise InputError(
            "the two are of different networks; give weights of one, before and after a training."
        )
    tensors = {
        name: tensor.float().lerp(other.tensors[name].float(), share)
        if tensor.is_floating_point()
        else other.tensors[name]
        for name, tensor in one.tensors.items()
    }
    return Weights(other.notes, tensors)


def _grown(small: Weights, large: Weights) -> Weights:
    """Return what the smaller network painted, as weights of the larger one; any others as they are.

    What only the larger one has is taken from it: there the smaller one does not hear it, and half of it
    then is no mixture with channels drawn at random.
    """
    if _shapes(small) == _shapes(large):
        return small
    before, after = small.generator(), large.generator()
    if not isinstance(before, ResidualUNetGenerator) or not isinstance(after, ResidualUNetGenerator):
        return small
    grow(before, after)
    return Weights(large.notes, after.state_dict())


def _shapes(weights: Weights) -> dict[str, tuple[int, ...]]:
    return {name: tuple(tensor.shape) for name, tensor in weights.tensors.items()}


def main() -> None:
    """Write the mean of two files."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("one")
    parser.add_argument("other")
    parser.add_argument("out", type=Path)
    parser.add_argument("--share", type=float, default=0.5)
    given = parser.parse_args()
    try:
        one, other = (read_weights(find_weights(name)) for name in (given.one, given.other))
        write_bytes(given.out, mean_weights(one, other, given.share).to_bytes())
    except InputError as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
