import numpy as np
import pytest
import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.inference.network.torch_backend import TorchBackend


class Channels(nn.Module):
    """Paints so many channels."""

    def __init__(self, count: int) -> None:
        super().__init__()
        self.count = count

    def forward(self, condition: Tensor) -> Tensor:
        return torch.full((len(condition), self.count, *condition.shape[2:]), 0.5)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_a_generator_of_other_channels_than_a_model_has_is_refused(count: int) -> None:
    backend = TorchBackend(Channels(count), 8)
    sentence = rf"^Channels returns {count} channels; a model has 3, or 4 with the confidence\.$"
    with pytest.raises(InputError, match=sentence):
        backend.predict(np.zeros((8, 8), np.float32))


@pytest.mark.parametrize("count", [3, 4])
def test_the_fourth_channel_is_the_confidence(count: int) -> None:
    normal, confidence = TorchBackend(Channels(count), 8).predict(np.zeros((8, 8), np.float32))
    assert normal.shape == (8, 8, 3)
    assert (confidence is not None) == (count == 4)
