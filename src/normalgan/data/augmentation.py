"""Augmentation: moves whole samples about, turning their normals along, and roughens the lines."""

from typing import Any, cast

import kornia.augmentation as K
import torch
import torch.nn.functional as F
from kornia.constants import DataKey, Resample
from kornia.geometry.transform import remap
from kornia.morphology import dilation, erosion
from torch import Tensor

from normalgan.batch import Batch
from normalgan.errors import InputError
from normalgan.metrics import unit_vectors


def turn_normals(normal: Tensor, transform: Tensor) -> Tensor:
    """Turn the vectors of a normal map as its pixels were moved.

    kornia moves pixels and leaves what they hold alone; but a picture that is turned shows an object that
    is turned, mirrored, an object that is mirrored, and stretched, one that is stretched. Normals are
    carried by the inverse transpose of what carries points; depth is taken to grow as the picture does,
    by the root of the growth of areas. The outline of the one is then that of the other.

    Args:
        normal: (N, 3, H, W) normals whose pixels have been moved already.
        transform: (N, 3, 3) that moved them, (x, y) in pixels, y down: affine, possibly mirrored.

    Returns:
        (N, 3, H, W) in their new directions; of the same lengths if ``transform`` is a similarity.
    """
    # By hand: torch.linalg.inv brings word from the device whether there is an inverse.
    (a, b), (c, d) = transform[:, 0, :2].unbind(1), transform[:, 1, :2].unbind(1)
    determinant = a * d - b * c
    inverse_transposed = torch.stack([d, -c, -b, a], dim=1).view(-1, 2, 2) / determinant[:, None, None]
    turn = determinant.abs().sqrt()[:, None, None] * inverse_transposed
    up = torch.tensor([1.0, -1.0], device=normal.device, dtype=normal.dtype)  # pixels have y down, normals up
    turn = up[:, None] * turn.to(normal.dtype) * up
    return torch.cat([torch.einsum("nij,njhw->nihw", turn, normal[:, :2]), normal[:, 2:]], dim=1)


def wobble(sketch: Tensor, strength: float) -> Tensor:
    """Move the lines about smoothly, each pixel by ``strength`` pixels or so (standard deviation)."""
    n, _, h, w = sketch.shape
    shift = torch.randn(n, 2, 9, 9, device=sketch.device) * strength
    shift = F.interpolate(shift, size=(h, w), mode="bicubic", align_corners=True)
    y, x = torch.meshgrid(
        torch.arange(h, device=sketch.device), torch.arange(w, device=sketch.device), indexing="ij"
    )
    moved: Tensor = remap(sketch, x + shift[:, 0], y + shift[:, 1], align_corners=True)
    return moved


def drop_lines(sketch: Tensor, share: float) -> Tensor:
    """Leave gaps: of each sketch erase blots that cover up to ``share`` of the paper."""
    n, _, h, w = sketch.shape
    noise = F.interpolate(torch.rand(n, 1, 17, 17, device=sketch.device), size=(h, w), mode="bilinear")
    erased = (torch.rand(n, device=sketch.device) * share * (h * w - 1)).long()
    # The lowest pixels alone are put in order: of whole pictures it would take longer than all else here.
    lowest = noise.flatten(1).topk(int(share * (h * w - 1)) + 1, dim=1, largest=False, sorted=True).values
    level = lowest.gather(1, erased[:, None]).view(n, 1, 1, 1)
    return sketch * (noise >= level)


def change_width(sketch: Tensor, strength: float) -> Tensor:
    """Make the lines of each sketch thicker or fainter, by up to ``strength`` of a 3 × 3 morphology."""
    cross = torch.tensor([[0.0, 1, 0], [1, 1, 1], [0, 1, 0]], device=sketch.device)
    amount = (torch.rand(len(sketch), 1, 1, 1, device=sketch.device) * 2 - 1) * strength
    thick, thin = dilation(sketch, cross), erosion(sketch, cross)
    return sketch + amount.clamp(min=0) * (thick - sketch) + amount.clamp(max=0) * (sketch - thin)


class Augmentation:
    """Random changes of training samples, batched on their device.

    The whole sample is mirrored, turned, scaled, stretched and moved; the sketch alone is roughened.

    Args:
        flip: probability of mirroring left and right.
        rotation: largest turn in degrees, either way.
        scale: least and largest scale.
        stretch: whether width and height are scaled each by a factor of its own, drawn from ``scale``: an
            animal becomes a longer or a taller one, which few meshes can make many.
        shear: largest slant in degrees, either way.
        translation: largest move along each axis, as a share of the side.
        jitter: how far lines wobble, in pixels of a sketch of 256 (standard deviation).
        dropout: largest share of the paper on which lines are left out.
        width: how much lines grow thicker or fainter, from 0 to 1.
    """

    def __init__(
        self,
        flip: float = 0.5,
        rotation: float = 10.0,
        scale: tuple[float, float] = (0.9, 1.1),
        translation: float = 0.03,
        jitter: float = 0.7,
        dropout: float = 0.05,
        width: float = 0.4,
        stretch: bool = False,
        shear: float = 0.0,
    ) -> None:
        for name, share in {
            "flip": flip,
            "dropout": dropout,
            "width": width,
            "translation": translation,
        }.items():
            if not 0 <= share <= 1:
                raise InputError(f"the augmentation's {name} must be between 0 and 1, not {share}.")
        if not 0 < scale[0] <= scale[1]:
            raise InputError(f"the augmentation's scale must be two positive numbers in order, not {scale}.")
        if rotation < 0 or jitter < 0:
            raise InputError("the augmentation's rotation and jitter must be 0 or more.")
        if not 0 <= shear <= 45:
            raise InputError(f"the augmentation's shear must be between 0 and 45 degrees, not {shear}.")
        self.settings: dict[str, Any] = {
            "flip": flip,
            "rotation": rotation,
            "scale": scale,
            "translation": translation,
            "jitter": jitter,
            "dropout": dropout,
            "width": width,
            "stretch": stretch,
            "shear": shear,
        }
        self.jitter = jitter
        self.dropout = dropout
        self.width = width
        self.geometric = K.AugmentationSequential(
            K.RandomHorizontalFlip(p=flip),
            K.RandomAffine(
                rotation,
                (translation, translation),
                (*scale, *scale) if stretch else scale,
                shear or None,
                p=1.0,
            ),
            data_keys=["input", "mask"],
            extra_args={DataKey.MASK: {"resample": Resample.NEAREST, "align_corners": None}},
        )

    def __call__(self, batch: Batch, seed: int) -> Batch:
        """Return an augmented batch; the same for the same seed.

        The normals of an object that is turned or stretched in the picture plane are those of the object so
        turned or stretched. Under perspective that holds but for the slight change of the direction of view
        at a moved pixel. Outlines stay outlines; folds inside a stretched object would be drawn slightly
        otherwise.
        """
        device = batch["sketch"].device
        with torch.random.fork_rng(devices=[device] if device.type == "cuda" else []):
            torch.manual_seed(seed)
            moved, mask = self.geometric(torch.cat([batch["sketch"], batch["normal"]], dim=1), batch["mask"])
            transform = cast(Tensor, self.geometric.transform_matrix)
            sketch = self.roughen(moved[:, :1])
        # Interpolation with the empty background shortens normals at the silhouette but does not turn them.
        normal = unit_vectors(turn_normals(moved[:, 1:], transform)) * mask
        return {**batch, "sketch": sketch, "normal": normal, "mask": mask}

    def roughen(self, sketch: Tensor) -> Tensor:
        """Return sketches (N, 1, H, W) with lines that wobble, have gaps and vary in width."""
        if self.jitter:
            sketch = wobble(sketch, self.jitter * sketch.shape[-1] / 256)
        if self.dropout:
            sketch = drop_lines(sketch, self.dropout)
        if self.width:
            sketch = change_width(sketch, self.width)
        return sketch.clamp(0, 1)
