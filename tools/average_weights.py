"""Averages the weights of a trained network with those that it was grown or trained from.

average_weights.py TRAINED START OUT.safetensors [--share 0.5]

TRAINED and START are checkpoints, safetensors or ONNX files. START may hold a smaller network that TRAINED
was grown from. A weight that both have becomes SHARE × TRAINED + (1 - SHARE) × START, and new channels keep
their values. Method: Wortsman et al. 2022, "Robust fine-tuning of zero-shot models".
"""

import argparse
from pathlib import Path

from normalgan.files.writing import write_bytes
from normalgan.models import ResidualUNetGenerator
from normalgan.models.growth import grow
from normalgan.weights.checkpoint import read_model
from normalgan.weights.file import Weights


def average(trained: Weights, start: Weights, share: float) -> Weights:
    """Return the average of two networks; the second may be smaller."""
    small, grown = start.generator(), trained.generator()
    assert isinstance(small, ResidualUNetGenerator)
    assert isinstance(grown, ResidualUNetGenerator)
    grow(small, grown)  # new channels, which no old channel reads, keep their trained values
    before = grown.state_dict()
    tensors = {
        name: tensor.float().lerp(before[name].float(), 1 - share) if tensor.is_floating_point() else tensor
        for name, tensor in trained.tensors.items()
    }
    return Weights(trained.notes, tensors)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("trained", type=Path)
    parser.add_argument("start", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--share", type=float, default=0.5)
    given = parser.parse_args()
    mean = average(read_model(given.trained), read_model(given.start), given.share)
    write_bytes(given.out, mean.to_bytes())
