"""Steadying: average the frames of an animation where they agree, so that still parts do not flicker."""

from collections.abc import Sequence

import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.inference.vectors import lengths

_REACH = 4
"""Number of frames before and after a frame that it is averaged with, as far as they agree."""
_AROUND = 1 / 32
"""Standard deviation of the window for comparing frames, as a fraction of the network's side."""
_ALIKE = 0.075
"""Mean difference of the ink in a window at which the weight of a frame has dropped to 1/e."""
_SAME = 0.05
"""Difference of two frames' normals, in radians, at which the weight has dropped to 1/e."""
_PASSES = 3
"""Number of averaging passes. Moving parts only match in adjacent frames, so distant frames need several."""


def steadied(seen: Sequence[Floats], preds: Sequence[Floats]) -> list[Floats]:
    """Return the predictions for an animation, each frame averaged with its neighbours in time.

    The weight of a neighbour at a pixel falls with the difference between the two drawings, blurred over a
    window. Blank paper looks the same everywhere, so the normals must agree too: a ball that moved a few
    pixels is a different surface. Where something moves, a frame keeps its own prediction. In slow motion,
    distant frames contribute through the frames between them.

    Args:
        seen: (S, S) each, the network's inputs, all framed by the same square.
        preds: (S, S, 3) each, the network's predictions.

    Example:
        >>> still = np.zeros((32, 32), np.float32)
        >>> tilted = [np.full((32, 32, 3), each, np.float32) for each in (0.0, 0.01)]
        >>> [round(float(each.mean()), 3) for each in steadied([still, still], tilted)]
        [0.005, 0.005]
    """
    width = max(_AROUND * seen[0].shape[0], 0.5) if seen else 1.0
    alike: dict[tuple[int, int], Floats] = {}
    for i, own in enumerate(seen):
        for j in range(i + 1, min(i + _REACH + 1, len(seen))):
            differ = cv2.GaussianBlur(np.abs(own - seen[j]), (0, 0), width)
            turned = lengths(preds[i] - preds[j])
            turned = np.maximum(turned, cv2.GaussianBlur(turned, (0, 0), width))
            apart = np.square(np.asarray(differ, np.float32) / np.float32(_ALIKE))
            apart += np.square(turned / np.float32(_SAME))
            alike[i, j] = alike[j, i] = np.exp(-apart)[..., None]
    means = list(preds)
    for _ in range(_PASSES):
        totals = [each.astype(np.float32) for each in means]
        weights = [np.ones((*each.shape[:2], 1), np.float32) for each in means]
        for (i, j), weight in alike.items():
            totals[i] += weight * means[j]
            weights[i] += weight
        means = [np.asarray(total / weight) for total, weight in zip(totals, weights, strict=True)]
    return means
