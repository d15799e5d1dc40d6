"""CurvatureHints: points of mild curvature, as sampled in the paper."""

import math
from dataclasses import dataclass
from typing import Literal

import torch
from torch import Tensor

from normalgan.errors import InputError
from normalgan.hints.base import HINT_SAMPLERS, HintSampler
from normalgan.hints.normal_curvature import Estimator, curvature_map
from normalgan.ranges import Count, NonNegative, Positive, UnitInterval

# Interpolated float32 normals of a plane differ by about 1e-7. Flat lies on the boundary of two grey
# levels (127.5), so without a dead zone such noise would select every other pixel of a plane.
_FLAT = 1e-5


@HINT_SAMPLERS.register
@dataclass(frozen=True)
class CurvatureHints(HintSampler):
    """Sample points of mild concavity by two thresholds of the curvature map, exclusive or, and dropout.

    After He et al., "Sketch-based Normal Map Generation with Geometric Sampling" (arXiv 2104.11554),
    section 4: the grey curvature map is thresholded at 127 and at 126, the exclusive or of the two binary
    images is kept, and each of its points is dropped with probability 0.95. The paper does not say how
    normals are converted to grey. The defaults follow from its text: flat is 128, concave is darker, and
    contrast is low. A single threshold then selects mostly the outline. The exclusive or selects level
    127: mild concavities, such as where a limb meets the body. Creases are several levels darker and are
    not selected. At 256 × 256, a view of a FourLeg mesh of the paper gets 20 to 275 points (median 90),
    and an embedded animal 8 to 274 (median 55). More detailed surfaces get more, and convex objects get
    none. With `rounding` ``floor``, flat is 127, so all flat areas are selected, including the background
    if `object_only` is off.

    The curvature is quantised to 8 bits; the normals never are.

    Args:
        estimator: derivative of the normals: ``central`` differences or ``sobel``.
        signed: divergence of the normals (True), or the norm of their gradient (False; set ``offset`` to
            0).
        blur: standard deviation of the Gaussian blur applied to the curvature, in pixels; 0 for no blur.
        normalisation: ``none``: grey = offset + gain · curvature. ``minmax``: each picture's curvature is
            stretched to 0…255, so flat is not a fixed grey, and ``gain`` is ignored.
        gain: change of grey (black 0, white 1) per 1/pixel of curvature; positive.
        offset: grey of a flat surface, 0…1.
        rounding: rounding of grey · 255 to integer levels: ``round`` (0.5 becomes 128) or ``floor`` (127).
        thresholds: the two grey levels, each 0…255, in any order.
        comparison: whether a level passes a threshold if ``greater`` or if ``greater_equal``.
        object_only: whether to keep only points on the object; outside it, hints would reveal the zero
            normal.
        dropout: probability that a selected point is dropped, 0…1; ignored if ``count`` is set.
        count: number of points to keep per sample, chosen at random from the selected ones, instead of
            dropout. If too few are selected, points of the nearest grey levels are added. Use it to
            compare samplers at equal numbers of hints.
    """

    estimator: Estimator = "central"
    signed: bool = True
    blur: NonNegative = 0.0
    normalisation: Literal["none", "minmax"] = "none"
    gain: Positive = 0.05
    offset: UnitInterval = 0.5
    rounding: Literal["round", "floor"] = "round"
    thresholds: tuple[int, int] = (127, 126)
    comparison: Literal["greater", "greater_equal"] = "greater"
    object_only: bool = True
    dropout: UnitInterval = 0.95
    count: Count | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if not len(self.thresholds) == len(set(range(256)).intersection(self.thresholds)) == 2:
            raise InputError(
                f"thresholds of CurvatureHints is {self.thresholds}; it must be two different levels from 0 "
                "to 255."
            )

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        """Return the hint mask, (N, 1, H, W) of the normals' type; see `HintSampler.sample`.

        The hints of a sample depend on its own normals and mask, its position in the batch, the batch
        shape and the state of ``rng``, but not on the other samples.
        """
        if self.count is not None:
            return self._nearest(normal, mask, rng, self.count)
        selected = self.select(normal, mask)
        kept = torch.rand(selected.shape, generator=rng, device=normal.device) >= self.dropout
        return (selected & kept).to(normal.dtype)

    def _nearest(self, normal: Tensor, mask: Tensor, rng: torch.Generator, count: int) -> Tensor:
        """Return ``count`` points with levels nearest to the selected ones; ties are broken at random."""
        low, high = sorted(self.thresholds)
        # The levels that `select` selects: with (127, 126) and "greater", 127 only.
        first, last = (low + 1, high) if self.comparison == "greater" else (low, high - 1)
        levels = self.levels(normal)
        away = (first - levels).clamp(min=0) + (levels - last).clamp(min=0)
        # Noise below one level only breaks ties.
        scores = torch.rand(levels.shape, generator=rng, device=normal.device).to(levels.dtype) - away
        if self.object_only:
            scores = scores.masked_fill(mask <= 0.5, -math.inf)
        best, pixels = scores.flatten(1).topk(min(count, scores[0].numel()), dim=1)
        where = torch.zeros_like(scores).flatten(1).scatter(1, pixels, best.isfinite().to(scores.dtype))
        return where.view_as(mask).to(normal.dtype)

    def select(self, normal: Tensor, mask: Tensor) -> Tensor:
        """Return the raw mask before the dropout: (N, 1, H, W), True at the selected points."""
        levels = self.levels(normal)
        first, second = self.thresholds
        if self.comparison == "greater":
            selected = (levels > first) ^ (levels > second)
        else:
            selected = (levels >= first) ^ (levels >= second)
        return selected & (mask > 0.5) if self.object_only else selected

    def levels(self, normal: Tensor) -> Tensor:
        """Return the 8-bit curvature map: (N, 1, H, W) integers 0…255, stored as floats."""
        curvature = curvature_map(normal, self.estimator, self.signed, self.blur)
        curvature = torch.where(curvature.abs() < _FLAT, torch.zeros_like(curvature), curvature)
        if self.normalisation == "none":
            grey = self.offset + self.gain * curvature
        else:
            low, high = curvature.amin((1, 2, 3), True), curvature.amax((1, 2, 3), True)
            flat = torch.full_like(curvature, self.offset)
            grey = torch.where(high > low, (curvature - low) / (high - low), flat)
        scaled = 255 * grey.clamp(0, 1)
        # Half up, not half to even, so that each boundary belongs to the upper level.
        return torch.floor(scaled + 0.5 if self.rounding == "round" else scaled)
