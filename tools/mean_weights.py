"""Makes the weighted mean of two trainings of one network: tools/mean_weights.py ONE OTHER OUT --share 0.5.

ONE and OTHER are safetensors of `normalgan export`, or ``shipped``; OUT is such a file, with the notes of
OTHER, in 32 bits; SHARE is how much OTHER counts. Of a network and its further training the mean is often
better than both, as errors that they do not share shrink (Wortsman et al. 2022, "Model soups").
"""

import argparse
from pathlib import Path

from normalgan.errors import InputError
from normalgan.files.writing import write_bytes
from normalgan.weights.file import Weights, find_weights, read_weights


def mean_weights(one: Weights, other: Weights, share: float) -> Weights:
    """Return weights between two of one network, statistics of norms among them, in 32 bits.

    Args:
        one: counts 1 - ``share``.
        other: counts ``share``; its notes are kept.
        share: 0 to 1.

    Raises:
        InputError: if they are of different networks, or the share is none.
    """
    if not 0 <= share <= 1:
        raise InputError(f"the share is {share}; give 0 to 1.")
    kinds = [{name: tensor.shape for name, tensor in weights.tensors.items()} for weights in (one, other)]
    if kinds[0] != kinds[1]:
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
