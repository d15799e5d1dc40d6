"""CurvatureHints: points of mild curvature, the sampler of the paper."""

import math
from dataclasses import dataclass
from typing import Literal

import torch
from torch import Tensor

from normalgan.errors import InputError
from normalgan.hints.base import HINT_SAMPLERS, HintSampler
from normalgan.hints.normal_curvature import Estimator, curvature_map
from normalgan.ranges import Count, NonNegative, Positive, Share, check_ranges

__all__ = ["CurvatureHints"]

# Interpolated float32 normals of a plane differ by some 1e-7. Flat sits on the edge of two grey levels
# (127.5), so without a dead zone such noise would hint every other pixel of a plane.
_FLAT = 1e-5


@HINT_SAMPLERS.register
@dataclass(frozen=True)
class CurvatureHints(HintSampler):
    """Sample points of mild concavity: two thresholds of the curvature map, exclusive or, dropout.

    After He et al., "Sketch-based Normal Map Generation with Geometric Sampling" (arXiv 2104.11554),
    section 4: the grey curvature map is cut at 127 and at 126, the exclusive or of the two binary images
    is kept, and each of its points is dropped with probability 0.95. The paper does not say how normals
    become grey. The defaults are the reading that fits its text: flat is 128, concave darker, low contrast.
    A single threshold then selects mostly the outline. The exclusive or selects level 127: mild
    concavities, such as where a limb meets the body. A crease is several levels darker and is left out.
    At 256 × 256, a view of the paper's FourLegs keeps 20 to 275 points (median 90), an embedded animal 8 to
    274 (median 55); finer surfaces keep more, and a convex object keeps none. With `rounding` ``floor``,
    flat is 127 and the rule selects everything flat, including the background if `object_only` is off.

    Only the curvature is quantised to 8 bits, never the normals.

    Args:
        estimator: derivative of the normals: ``central`` differences or ``sobel``.
        signed: divergence of the normals (True), or the length of their gradient (False; set offset 0).
        blur: standard deviation in pixels of a Gaussian on the curvature; 0 for none.
        normalisation: ``none``: grey = offset + gain · curvature. ``minmax``: each picture's curvature is
            stretched over 0…255, gain is not used, and flat is not a fixed grey.
        gain: grey per curvature of 1/pixel, where black is 0 and white 1; positive.
        offset: grey of flat, 0…1.
        rounding: rounding of grey · 255 to whole levels: ``round`` (0.5 becomes 128) or ``floor`` (127).
        thresholds: the two levels, each 0…255, that cut the curvature map, in any order.
        comparison: a level passes a threshold if ``greater`` or if ``greater_equal``.
        object_only: keep only points on the object; off it, hints would give away the zero normal.
        dropout: probability that a selected point is dropped, 0…1; not used with a count.
        count: number of points to keep of each sample, chosen at random from the selected ones, instead of
            dropout. If too few are selected, points of the nearest grey levels are added. Use it to compare
            samplers at equal numbers of hints.
    """

    estimator: Estimator = "central"
    signed: bool = True
    blur: NonNegative = 0.0
    normalisation: Literal["none", "minmax"] = "none"
    gain: Positive = 0.05
    offset: Share = 0.5
    rounding: Literal["round", "floor"] = "round"
    thresholds: tuple[int, int] = (127, 126)
    comparison: Literal["greater", "greater_equal"] = "greater"
    object_only: bool = True
    dropout: Share = 0.95
    count: Count | None = None

    def __post_init__(self) -> None:
        check_ranges(self)
        if not len(self.thresholds) == len(set(range(256)).intersection(self.thresholds)) == 2:
            raise InputError(
                f"thresholds of CurvatureHints is {self.thresholds}; it must be two different levels from 0 "
                "to 255."
            )

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        """Return where the hints are, (N, 1, H, W) of the normals' type; see `HintSampler.sample`.

        A sample's hints depend on its own normals and mask, its place in the batch, the shape of the batch
        and the state of ``rng``, but not on the other samples.
        """
        if self.count is not None:
            return self._nearest(normal, mask, rng, self.count)
        selected = self.select(normal, mask)
        kept = torch.rand(selected.shape, generator=rng, device=normal.device) >= self.dropout
        return (selected & kept).to(normal.dtype)

    def _nearest(self, normal: Tensor, mask: Tensor, rng: torch.Generator, count: int) -> Tensor:
        """Return ``count`` points of the levels nearest to the selected ones; ties are broken at random."""
        low, high = sorted(self.thresholds)
        first, last = (low + 1, high) if self.comparison == "greater" else (low, high - 1)
        levels = self.levels(normal)
        away = (first - levels).clamp(min=0) + (levels - last).clamp(min=0)
        # Less than a whole level: chance decides among equals alone.
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
        """Return the 8-bit curvature map: (N, 1, H, W) whole numbers 0…255, as floats."""
        curvature = curvature_map(normal, self.estimator, self.signed, self.blur)
        curvature = torch.where(curvature.abs() < _FLAT, torch.zeros_like(curvature), curvature)
        if self.normalisation == "none":
            grey = self.offset + self.gain * curvature
        else:
            low, high = curvature.amin((1, 2, 3), True), curvature.amax((1, 2, 3), True)
            flat = torch.full_like(curvature, self.offset)
            grey = torch.where(high > low, (curvature - low) / (high - low), flat)
        scaled = 255 * grey.clamp(0, 1)
        # Half up, not half to even: both edges of a level then belong to the same side.
        return torch.floor(scaled + 0.5 if self.rounding == "round" else scaled)
