"""Full precision for single layers of a network that autocast runs in bfloat16."""

import torch
from torch import Tensor, nn

__all__ = ["float32_output"]


def float32_output(layer: nn.Module, features: Tensor) -> Tensor:
    """Return what a layer makes of features (N, C, H, W), computed in float32 under autocast too.

    For what is read as numbers: in the eight bits of bfloat16 a logit of 5 goes in steps of 0.03.
    """
    kind = features.device.type
    if not torch.is_autocast_enabled(kind):
        result: Tensor = layer(features)
        return result.float()  # of a network that is bfloat16 throughout
    with torch.autocast(kind, enabled=False):
        return float32_output(layer, features.float())
