"""Makes weights paint steeper slopes: tools/steeper_weights.py WEIGHTS OUT --slopes 1.02.

WEIGHTS is safetensors of `normalgan export` of a ResidualUNetGenerator, or ``shipped``; OUT is such a file,
in 32 bits. What minimises the mean angle to normals that the lines leave open is flatter than these are, and
means of several maps are flatter still. The network's last convolutions give x, y and z before they are
scaled to length 1: with x and y a little longer the mean slope is nearer to the true one. Choose the factor
on the validation split.
"""

import argparse
from pathlib import Path

from normalgan.errors import InputError
from normalgan.files.writing import write_bytes
from normalgan.models import ResidualUNetGenerator
from normalgan.weights.file import Weights, find_weights, read_weights


def steeper(weights: Weights, slopes: float) -> Weights:
    """Return weights whose normals lean more, in 32 bits: (x, y, z) becomes (``slopes`` x, ``slopes`` y, z).

    Confidence and mask stay as they are. So does all else where nothing is averaged: ``deblock`` and
    ``mirror`` take means of the steeper normals.

    Args:
        weights: of a `ResidualUNetGenerator`.
        slopes: above 0; 1 leaves them.

    Raises:
        InputError: if they are of another network, or the factor is none.
    """
    if not 0 < slopes < float("inf"):
        raise InputError(f"the slopes are multiplied by {slopes}; give a number above 0.")
    network = weights.generator()
    if not isinstance(network, ResidualUNetGenerator):
        raise InputError(
            f"these are weights of {weights.notes.generator.name}; give a ResidualUNetGenerator's."
        )
    tensors = {name: t.float() if t.is_floating_point() else t for name, t in weights.tensors.items()}
    # x and y are the first two heads, each of as many channels as pixels are folded into one.
    for name, pixels in (("heads", network.patch**2), ("detail.2", network.fold**2)):
        for part in ("weight", "bias"):
            tensor = tensors[f"{name}.{part}"].clone()
            tensor[: 2 * pixels] *= slopes
            tensors[f"{name}.{part}"] = tensor
    shown = tensors["detail.0.weight"].clone()  # the finest layers are shown them as they learnt to see them
    shown[:, : 2 * network.fold**2] /= slopes
    return Weights(weights.notes, {**tensors, "detail.0.weight": shown})


def main() -> None:
    """Write the steeper weights."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("weights")
    parser.add_argument("out", type=Path)
    parser.add_argument("--slopes", type=float, required=True)
    given = parser.parse_args()
    try:
        write_bytes(given.out, steeper(read_weights(find_weights(given.weights)), given.slopes).to_bytes())
    except InputError as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
