"""From parts to a closed, centred mesh by marching cubes."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.measure import marching_cubes, mesh_surface_area

from normalgan.animals.field import MARGIN, Grid, Part, sample
from normalgan.animals.frames import Floats, Volume
from normalgan.animals.shapes import Sweep
from normalgan.rendering.mesh import Mesh

__all__ = [
    "COARSER",
    "CRUMB",
    "FACES",
    "OVERLAP",
    "THINNEST",
    "TRUSTED",
    "drop_crumbs",
    "fill_voids",
    "to_mesh",
    "unit_sphere",
]

FACES = 32_000  # about the number aimed at
THINNEST = 1.35  # grid cells: a thinner radius would break up into beads
COARSER = 4  # times fewer faces than aimed at, when the skin is measured
OVERLAP = 1.28  # how much more than their union's the surface of parts usually is
TRUSTED = (0.7, 1.25)  # measured over estimated skin within which the estimate is kept
CRUMB = 60  # grid cells: what is smaller and hangs on nothing was left over between a part and a hollow


def to_mesh(name: str, parts: Sequence[Part], count: int = FACES) -> Mesh:
    """Return the surface of the blended parts, centred and scaled to a bounding sphere of radius 1.

    Args:
        name: of the mesh.
        parts: in the order in which they blend.
        count: about how many faces it is to have.

    The spacing of the grid follows from the surface of the parts, so that an animal has the same number
    of faces whether lean or fat. Normals are the gradient of the field, smoother than those of the faces.
    """
    field = _field(parts, _spacing(parts, count))
    surface = marching_cubes(field, 0.0, allow_degenerate=False)
    vertices, faces, normals, _ = surface
    normals = _unit(-normals.astype(np.float64))  # scikit-image's run inwards where the outside is positive
    centred = unit_sphere(vertices.astype(np.float64))
    return Mesh(name, centred.astype(np.float32), faces.astype(np.int32), normals.astype(np.float32))


def _spacing(parts: Sequence[Part], count: int) -> float:
    """Return the distance of grid points that gives about ``count`` faces."""
    added = [shape for part in parts if not part.carve for shape in part.shapes]
    skin = sum(shape.smoothed().area() for shape in added if isinstance(shape, Sweep))
    skin += sum(shape.area() for shape in added if not isinstance(shape, Sweep))
    if not all(isinstance(shape, Sweep) for part in parts for shape in part.shapes):
        # Solids may lie deep in one another, or be hollowed out: measured on a coarse grid, the skin may
        # turn out another. Not so with sweeps; and thin ones, which a coarse grid fattens, add up better.
        coarse = float(np.sqrt(2.35 * skin * COARSER / count))
        vertices, faces, _, _ = marching_cubes(_field(parts, coarse), 0.0)
        measured = OVERLAP * float(mesh_surface_area(vertices, faces)) * coarse**2
        if not TRUSTED[0] < measured / skin < TRUSTED[1]:
            skin = measured
    return float(np.sqrt(2.35 * skin / count))


def _field(parts: Sequence[Part], spacing: float) -> Volume:
    """Return the field of the parts on a grid round them all, its voids and crumbs gone."""
    fine = [_fine(part, THINNEST * spacing) for part in parts]
    corners = [part.reach() for part in fine if not part.carve]
    # Blends swell the union by at most a sixth of their width: two cells more than the margin hold that.
    pad = (MARGIN + 2) * spacing
    low = np.min([corner[0] for corner in corners], axis=0) - pad
    high = np.max([corner[1] for corner in corners], axis=0) + pad
    nx, ny, nz = np.ceil((high - low) / spacing).astype(int) + 1
    field = sample(fine, Grid(low, spacing, (int(nx), int(ny), int(nz))))
    return drop_crumbs(fill_voids(ndimage.gaussian_filter(field, 0.7, truncate=2.9)))


def fill_voids(field: Volume) -> Volume:
    """Return the field with pockets of outside that are shut in turned to inside."""
    labels, count = ndimage.label(field > 0)
    if count > 1:
        field = np.where((field > 0) & (labels != labels[0, 0, 0]), np.float32(-1e-3), field)
    return field


def drop_crumbs(field: Volume) -> Volume:
    """Return the field without what is inside but apart from the rest and smaller than `CRUMB` cells."""
    labels, count = ndimage.label(field < 0)
    if count > 1:
        small = np.bincount(labels.ravel()) < CRUMB
        small[0] = False
        field = np.where(small[labels], np.float32(1e-3), field)
    return field


def unit_sphere(points: Floats) -> Floats:
    """Return the points moved and scaled so that their bounding sphere is the unit sphere.

    The centre walks towards the farthest point by shrinking steps (Bădoiu and Clarkson, "Smaller core-sets
    for balls", 2003); after 300 steps the radius is within 1 % of the smallest one.
    """
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    for step in range(2, 302):
        offsets = points - centre
        farthest = points[np.argmax(np.einsum("ij,ij->i", offsets, offsets))]
        centre = centre + (farthest - centre) / step
    offsets = points - centre
    scaled: Floats = offsets / np.sqrt(np.max(np.einsum("ij,ij->i", offsets, offsets)))
    return scaled


def _fine(part: Part, thinnest: float) -> Part:
    return replace(part, shapes=tuple(shape.thickened(thinnest) for shape in part.shapes))


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: NDArray[np.float64] = vectors / np.maximum(lengths, 1e-12)
    return unit
