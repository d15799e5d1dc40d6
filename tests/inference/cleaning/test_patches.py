"""Patches of a drawing, against what OpenCV measures."""

import cv2
import numpy as np

from normalgan.inference.cleaning.patches import patches


def test_patches_are_as_wide_and_high_as_opencv_measures_them() -> None:
    marked = cv2.GaussianBlur(np.random.default_rng(1).random((90, 70)), (0, 0), 1.5) > 0.52
    numbers, sizes = patches(marked)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(marked.astype(np.uint8), connectivity=8)
    assert count > 20
    assert (numbers == labels).all()
    assert (sizes[1:] == stats[1:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]]).all()


def test_of_nothing_there_is_no_patch() -> None:
    numbers, sizes = patches(np.zeros((5, 4), bool))
    assert not numbers.any()
    assert sizes.tolist() == [[0, 0]]
