"""Augmentation: random transforms of whole samples, including their normals, and rough lines."""

import dataclasses
import functools
import math
from abc import ABC, abstractmethod
from typing import Annotated, Any, cast

import torch
import torch.nn.functional as F
from torch import Tensor

from normalgan.batch import Batch
from normalgan.contracts import class_name, describe, refused
from normalgan.data.surface_marks import mark_surfaces
from normalgan.errors import InputError
from normalgan.losses.distractor_consistency import add_distractor_strokes
from normalgan.ranges import NonNegative, Range, RangeChecked, UnitInterval
from normalgan.registry import Registry
from normalgan.seeds import seed_torch
from normalgan.vectors import unit_vectors, unit_vectors_within


class BatchAugmentation(RangeChecked, ABC):
    """Base class of augmentations: random changes of training batches, on the batch's device.

    An augmentation is a frozen dataclass of plain settings. If it moves pixels, it must move those of
    sketch, normals, mask and, if the batch has any, hints, and rotate the vectors with `turn_normals` and
    `_move_hints`.
    """

    @abstractmethod
    def __call__(self, batch: Batch, seed: int) -> Batch:
        """Return an augmented copy of a batch.

        Args:
            batch: batch on any device.
            seed: seed of all randomness. The same seed gives the same changes, so a resumed run is
                reproducible.
        """

    def describe(self) -> dict[str, Any]:
        """Return everything except the seed that the changes depend on, as plain values for JSON.

        Raises:
            TypeError: if the class is not a dataclass and does not override this method.
        """
        settings: Any = self
        if not dataclasses.is_dataclass(settings):
            raise TypeError(
                f"{type(self).__name__} is not a dataclass, so it must return its settings from describe()."
            )
        return {
            "class": type(self).__name__,
            **{f.name: getattr(self, f.name) for f in dataclasses.fields(settings)},
        }


AUGMENTATIONS: Registry[BatchAugmentation] = Registry(BatchAugmentation, "normalgan.augmentations")  # type: ignore[type-abstract]


def augmented(augmentation: BatchAugmentation, batch: Batch, seed: int) -> Batch:
    """Apply an augmentation to a batch.

    Raises:
        InputError: if the augmentation did not return a batch with the same entries of the same sizes.
            Lightning would skip None and not train at all.
    """
    given: object = augmentation(batch, seed)
    asked = "an augmentation gives a batch with all that it was given"
    if not isinstance(given, dict):
        raise refused(augmentation, given, asked)
    for name, before in batch.items():
        if name not in given:
            raise InputError(f"{class_name(augmentation)} gave a batch without {name}; {asked}.")
        after = given[name]
        if isinstance(before, Tensor) and not (isinstance(after, Tensor) and after.shape == before.shape):
            raise InputError(
                f"{class_name(augmentation)} gave {describe(after)} as {name}, of which there was "
                f"{describe(before)}; sizes stay as they are."
            )
    return cast(Batch, given)


def turn_normals(normal: Tensor, transform: Tensor) -> Tensor:
    """Transform the vectors of a normal map after its pixels were moved.

    A rotated, mirrored or stretched picture shows a rotated, mirrored or stretched object. The normals
    must therefore change by the inverse transpose of the transform of points. Depth scales with the square
    root of the change of area, so the new normals agree with the new outline.

    Args:
        normal: (N, 3, H, W) normals after their pixels were moved.
        transform: (N, 3, 3) transform that moved the pixels, (x, y) in pixels, y down: affine, possibly
            mirrored.

    Returns:
        (N, 3, H, W) in their new directions, with the same lengths if ``transform`` is a similarity.
    """
    # torch.linalg.inv would wait for the device to check whether the matrix is invertible.
    (a, b), (c, d) = transform[:, 0, :2].unbind(1), transform[:, 1, :2].unbind(1)
    determinant = a * d - b * c
    inverse_transposed = torch.stack([d, -c, -b, a], dim=1).view(-1, 2, 2) / determinant[:, None, None]
    turn = determinant.abs().sqrt()[:, None, None] * inverse_transposed
    up = torch.tensor([1.0, -1.0], device=normal.device, dtype=normal.dtype)  # y is down in pixels
    turn = up[:, None] * turn.to(normal.dtype) * up
    return torch.cat([torch.einsum("nij,njhw->nihw", turn, normal[:, :2]), normal[:, 2:]], dim=1)


def sampling_grid(transform: Tensor, side: int) -> Tensor:
    """Return the source of each pixel of a moved picture.

    Args:
        transform: (N, 3, 3) transform of the picture, (x, y) in pixels, y down, pixel (0, 0) at the
            origin.
        side: H and W.

    Returns:
        (N, H, W, 2), a grid for `torch.nn.functional.grid_sample` with ``align_corners=False``.
    """
    a, b, x, c, d, y = transform[:, :2].flatten(1).T[:, :, None, None]  # each (N, 1, 1)
    across = torch.arange(side, device=transform.device, dtype=transform.dtype)
    right, down = across - x, across[:, None] - y  # (N, 1, W) and (N, H, 1)
    fit = 2 / (side * (a * d - b * c))
    first = 1 / side - 1  # the centre of pixel 0 is half a pixel from the border at -1
    # F.affine_grid is slower on a CPU.
    planes = [(d * fit * right + first) - b * fit * down, (a * fit * down + first) - c * fit * right]
    return torch.stack(planes, dim=1).permute(0, 2, 3, 1)


@functools.lru_cache(maxsize=16)
def _weights(points: int, side: int, mode: str, device: torch.device) -> Tensor:
    """Return the interpolation weights (side, points) of evenly spaced points at each pixel."""
    each = torch.eye(points, device=device)[:, None, :, None]  # picture i is 1 only at point i
    return F.interpolate(each, size=(side, 1), mode=mode, align_corners=True)[:, 0, :, 0].T.contiguous()


def smooth_noise(values: Tensor, side: int, mode: str) -> Tensor:
    """Interpolate a coarse grid of values (N, C, P, P) to pictures (N, C, H, W).

    On a CPU, two small matrix products are faster than `torch.nn.functional.interpolate`.

    Args:
        values: (N, C, P, P), with the outermost points on the border.
        side: H and W.
        mode: "bilinear" or "bicubic", as in ``interpolate``.
    """
    weights = _weights(values.shape[-1], side, mode, values.device)
    return weights @ values @ weights.T


def _smooth_shifts(count: int, side: int, strength: float, device: torch.device) -> Tensor:
    """Return smooth random displacements (N, H, W, 2) with standard deviation ``strength``."""
    shift = torch.randn(count, 2, 9, 9, device=device) * strength
    return smooth_noise(shift, side, "bicubic").permute(0, 2, 3, 1)


def sample_at(picture: Tensor, grid: Tensor) -> Tensor:
    """Sample pictures (N, C, H, W) at the points of a grid (N, H, W, 2), with 0 outside the picture."""
    return F.grid_sample(picture, grid, mode="bilinear", padding_mode="zeros", align_corners=False)


def _move_hints(hints: Tensor, transform: Tensor) -> Tensor:
    """Move hints with their pixels and transform their normals.

    Each hint stays a single pixel, because interpolation would fade it. Hints outside the picture are
    dropped. If two hints move to the same pixel, one is kept.

    Args:
        hints: (N, 4, H, W): hint normals and hint mask.
        transform: (N, 3, 3) transform of the pixels, as in `turn_normals`.
    """
    height, width = hints.shape[2:]
    turned = unit_vectors(turn_normals(hints[:, :3], transform))
    sample, row, column = (hints[:, 3] > 0.5).nonzero(as_tuple=True)
    place = torch.stack([column, row, torch.ones_like(row)], dim=1).to(transform.dtype)
    x, y = torch.einsum("kij,kj->ki", transform[sample, :2], place).round().long().unbind(1)
    inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
    moved = torch.zeros_like(hints)
    given = torch.cat([turned[sample, :, row, column], torch.ones_like(place[:, :1])], dim=1).to(hints.dtype)
    moved[sample[inside], :, y[inside], x[inside]] = given[inside]
    return moved


def wobble(sketch: Tensor, strength: float) -> Tensor:
    """Displace the lines smoothly, by ``strength`` pixels (standard deviation)."""
    count, side = len(sketch), sketch.shape[-1]
    still = torch.eye(3, device=sketch.device).expand(count, 3, 3)
    shift = _smooth_shifts(count, side, strength * 2 / side, sketch.device)  # the grid is 2 wide
    return sample_at(sketch, sampling_grid(still, side) + shift)


def drop_lines(sketch: Tensor, share: float) -> Tensor:
    """Erase blobs that cover up to a fraction ``share`` of each sketch, which leaves gaps in its lines."""
    n, side = len(sketch), sketch.shape[-1]
    noise = smooth_noise(torch.rand(n, 1, 17, 17, device=sketch.device), side, "bilinear")
    # Only every fourth pixel is sorted, because sorting all would take longer than everything else here.
    some = noise[:, :, ::2, ::2].flatten(1)
    most = share * (some.shape[1] - 1)
    erased = (torch.rand(n, device=sketch.device) * most).long()
    lowest = some.topk(int(most) + 1, dim=1, largest=False, sorted=True).values
    # Noise between the sorted pixels may be lower still, so where nothing is to be erased, the level
    # is -1.
    level = lowest.gather(1, erased[:, None])[:, 0].masked_fill(erased == 0, -1.0)
    return sketch * (noise >= level.view(n, 1, 1, 1))


def change_width(sketch: Tensor, strength: float) -> Tensor:
    """Make lines thicker or fainter by blending in a 3 × 3 dilation or erosion with up to ``strength``."""
    from kornia.morphology import dilation  # listing the plug-ins does not need kornia

    cross = torch.tensor([[0.0, 1, 0], [1, 1, 1], [0, 1, 0]], device=sketch.device)
    amount = (torch.rand(len(sketch), 1, 1, 1, device=sketch.device) * 2 - 1) * strength
    sign = torch.where(amount < 0, -1.0, 1.0)
    # Erosion is the dilation of the negative, so a single dilation serves both.
    return torch.lerp(sketch, sign * dilation(sign * sketch, cross), amount.abs())


@AUGMENTATIONS.register
@dataclasses.dataclass(frozen=True)
class Augmentation(BatchAugmentation):
    """Random changes of training samples, batched on their device.

    Whole samples are mirrored, rotated, scaled, stretched and moved. Gaps, wobble and line widths change
    only the sketch.

    Args:
        flip: probability of a horizontal flip.
        rotation: maximum rotation in degrees, in either direction.
        scale: minimum and maximum scale.
        stretch: whether width and height get separate factors from ``scale``, so that a few meshes become
            many longer and taller ones.
        shear: maximum shear in degrees, in either direction.
        distractor_strokes: probability of each of two short meaningless strokes on the object.
        fills: probability that areas of the drawing are filled black, with or without white lines.
        decals: probability of text, a logo, windows, spots or stripes on the object.
        hatching: probability that the side of the object away from a light is hatched.
        translation: maximum translation along each axis, as a fraction of the side.
        jitter: standard deviation of the wobble of lines, in pixels of a 256-pixel sketch.
        dropout: maximum fraction of the paper where lines are erased.
        width: amount by which lines get thicker or fainter, from 0 to 1.
    """

    flip: UnitInterval = 0.5
    rotation: NonNegative = 10.0
    scale: Annotated[tuple[float, float], Range(0, above=True)] = (0.9, 1.1)
    translation: UnitInterval = 0.03
    jitter: NonNegative = 0.7
    dropout: UnitInterval = 0.05
    width: UnitInterval = 0.4
    stretch: bool = False
    shear: Annotated[float, Range(0, 45)] = 0.0
    distractor_strokes: UnitInterval = 0.0
    fills: UnitInterval = 0.0
    decals: UnitInterval = 0.0
    hatching: UnitInterval = 0.0

    def __call__(self, batch: Batch, seed: int) -> Batch:
        """Return an augmented batch; equal for equal seeds.

        The normals are exact for an object that is rotated or stretched in the picture plane. Under
        perspective, the viewing direction of a moved pixel changes slightly, which is ignored. Outlines
        stay correct, but folds inside a stretched object would be drawn slightly differently.
        """
        sketch, normal, mask = batch["sketch"], batch["normal"], batch["mask"]
        device, (count, _, _, side) = sketch.device, sketch.shape
        with torch.random.fork_rng(devices=[device] if device.type == "cuda" else []):
            seed_torch(seed, device)
            transform = self.draw_transform(count, side, device)
            grid = sampling_grid(transform, side)
            # Transform and wobble are one step, because two interpolations would blur lines twice.
            shift = _smooth_shifts(count, side, self.jitter * 2 / 256, device) if self.jitter else 0.0
            sketch = self.roughen(sample_at(sketch, grid + shift))
            moved = sample_at(torch.cat([normal, mask], dim=1), grid)
            mask = (moved[:, 3:] > 0.5).to(mask.dtype)
            if self.distractor_strokes:
                sketch = add_distractor_strokes(sketch, mask, self.distractor_strokes)
        # Interpolation with the empty background shortens normals at the silhouette but does not rotate
        # them.
        normal = unit_vectors_within(turn_normals(moved[:, :3], transform), mask)
        if self.fills or self.decals or self.hatching:
            sketch = mark_surfaces(sketch, normal, mask, seed, self.fills, self.decals, self.hatching)
        augmented: Batch = {**batch, "sketch": sketch, "normal": normal, "mask": mask}
        if "hints" in batch:
            augmented["hints"] = _move_hints(batch["hints"], transform)
        return augmented

    def describe(self) -> dict[str, Any]:
        """Return the settings."""
        return dataclasses.asdict(self)

    def draw_transform(self, count: int, side: int, device: torch.device) -> Tensor:
        """Draw random transforms for ``count`` pictures, (N, 3, 3) for (x, y) in pixels, y down.

        All numbers are drawn on the device, so the CPU does not wait for it.
        """
        from kornia.geometry.transform import get_affine_matrix2d  # as above

        mirrored, turned, wide, tall, slanted, right, down = torch.rand(7, count, device=device)
        sign = 1 - 2 * (mirrored < self.flip).float()
        least, most = self.scale
        width = least + (most - least) * wide
        height = least + (most - least) * tall if self.stretch else width
        slant = math.radians(self.shear) * (2 * slanted - 1)
        return get_affine_matrix2d(
            translations=self.translation * side * (2 * torch.stack([right, down], dim=1) - 1),
            center=torch.full((count, 2), (side - 1) / 2, device=device),
            scale=torch.stack([sign * width, height], dim=1),
            angle=self.rotation * (2 * turned - 1),
            sx=slant,
            sy=torch.zeros_like(slant),
        )

    def roughen(self, sketch: Tensor) -> Tensor:
        """Add gaps and varying widths to the lines of sketches (N, 1, H, W)."""
        if self.dropout:
            sketch = drop_lines(sketch, self.dropout)
        if self.width:
            sketch = change_width(sketch, self.width)
        return sketch.clamp(0, 1)
