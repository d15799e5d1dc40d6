"""Meshing: a field of blended parts, and its closed, centred surface by marching cubes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from skimage.measure import marching_cubes, mesh_surface_area

from normalgan.animals.frames import Axes, Volume
from normalgan.animals.parts import Part, Ripple
from normalgan.animals.shapes import Sweep, smooth_minimum
from normalgan.arrays import Doubles
from normalgan.rendering.mesh import Mesh

_Window = tuple[slice, slice, slice]
_FAR = np.float32(10.0)  # value of the field far from all parts
_MARGIN = 4  # number of grid cells around a part where its field is valid
_TARGET_FACES = 32_000  # approximate target
_THINNEST_RADIUS = 1.35  # in grid cells; a smaller radius would break up into beads
_COARSE_RATIO = 4  # ratio of target faces to faces of the coarse mesh that measures the area
_OVERLAP = 1.28  # usual ratio of the parts' total area to the area of their union
_TRUSTED_RATIOS = (0.7, 1.25)  # ratios of measured to estimated area for which the estimate is kept
_LARGEST_CRUMB = 60  # in grid cells; smaller separate pieces are leftovers between a part and a hollow


def to_mesh(name: str, parts: Sequence[Part], count: int = _TARGET_FACES) -> Mesh:
    """Return the surface of the blended parts, centred and scaled to a bounding sphere of radius 1.

    Args:
        name: name of the mesh.
        parts: parts in blending order.
        count: approximate number of faces.

    The grid spacing is derived from the surface area of the parts, so that lean and fat animals have the
    same number of faces. Normals are gradients of the field, which are smoother than face normals.
    """
    field = _field(parts, _spacing(parts, count))
    vertices, faces, normals, _ = marching_cubes(field, 0.0, allow_degenerate=False)
    normals = -normals.astype(np.float64)  # scikit-image's normals point inwards if the outside is positive
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    centred = unit_sphere(vertices.astype(np.float64))
    return Mesh(name, centred.astype(np.float32), faces.astype(np.int32), normals.astype(np.float32))


def _spacing(parts: Sequence[Part], count: int) -> float:
    """Return the grid spacing that gives about ``count`` faces."""
    added = [shape for part in parts if not part.carve for shape in part.shapes]
    skin = sum(shape.smoothed().area() for shape in added if isinstance(shape, Sweep))
    skin += sum(shape.area() for shape in added if not isinstance(shape, Sweep))
    if not all(isinstance(shape, Sweep) for part in parts for shape in part.shapes):
        # Solids may overlap strongly or be hollowed out, so the area is measured on a coarse grid. For
        # sweeps, the sum of areas is better, because they overlap little and a coarse grid thickens thin
        # ones.
        coarse = float(np.sqrt(2.35 * skin * _COARSE_RATIO / count))
        vertices, faces, _, _ = marching_cubes(_field(parts, coarse), 0.0)
        measured = _OVERLAP * float(mesh_surface_area(vertices, faces)) * coarse**2
        if not _TRUSTED_RATIOS[0] < measured / skin < _TRUSTED_RATIOS[1]:
            skin = measured
    return float(np.sqrt(2.35 * skin / count))


def _field(parts: Sequence[Part], spacing: float) -> Volume:
    """Return the field of the parts on a grid around all of them, without voids and loose crumbs."""
    fine = [part.thickened(_THINNEST_RADIUS * spacing) for part in parts]
    corners = [part.reach() for part in fine if not part.carve]
    # Blends extend the union by at most a sixth of their width, for which two extra cells are enough.
    pad = (_MARGIN + 2) * spacing
    low = np.stack([corner[0] for corner in corners]).min(0) - pad
    high = np.stack([corner[1] for corner in corners]).max(0) + pad
    nx, ny, nz = np.ceil((high - low) / spacing).astype(int) + 1
    field = _sample(fine, _Grid(low, spacing, (int(nx), int(ny), int(nz))))
    return drop_crumbs(fill_voids(ndimage.gaussian_filter(field, 0.7, truncate=2.9)))


def fill_voids(field: Volume) -> Volume:
    """Return the field with enclosed pockets filled."""
    labels, count = ndimage.label(field > 0)
    if count > 1:
        field = np.where((field > 0) & (labels != labels[0, 0, 0]), np.float32(-1e-3), field)
    return field


def drop_crumbs(field: Volume) -> Volume:
    """Return the field without separate pieces smaller than `_LARGEST_CRUMB` cells."""
    labels, count = ndimage.label(field < 0)
    if count > 1:
        small = np.bincount(labels.ravel()) < _LARGEST_CRUMB
        small[0] = False
        field = np.where(small[labels], np.float32(1e-3), field)
    return field


def unit_sphere(points: Doubles) -> Doubles:
    """Return the points moved and scaled so that their bounding sphere is the unit sphere.

    The centre moves towards the farthest point by decreasing steps (Bădoiu and Clarkson, "Smaller
    core-sets for balls", 2003). After 300 steps, the radius is within 1 % of the minimum.
    """
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    for step in range(2, 302):
        offsets = points - centre
        farthest = points[np.argmax(np.einsum("ij,ij->i", offsets, offsets))]
        centre = centre + (farthest - centre) / step
    offsets = points - centre
    scaled: Doubles = offsets / np.sqrt(np.max(np.einsum("ij,ij->i", offsets, offsets)))
    return scaled


@dataclass(frozen=True, eq=False)
class _Grid:
    """The grid on which the field is sampled.

    Args:
        origin: (3,) lowest corner.
        spacing: distance between neighbouring samples.
        shape: number of samples along x, y, z.
    """

    origin: Doubles
    spacing: float
    shape: tuple[int, int, int]

    def window(self, low: Doubles, high: Doubles) -> _Window:
        """Return the slices of the samples in a box."""
        first = np.clip(np.floor((low - self.origin) / self.spacing), 0, self.shape).astype(int)
        last = np.clip(np.ceil((high - self.origin) / self.spacing) + 1, 0, self.shape).astype(int)
        return slice(first[0], last[0]), slice(first[1], last[1]), slice(first[2], last[2])

    def axes(self, window: _Window) -> Axes:
        """Return the coordinates of the samples in a window."""
        steps = zip(self.origin, np.ogrid[window], strict=True)
        x, y, z = ((start + self.spacing * step).astype(np.float32) for start, step in steps)
        return x, y, z


def _sample(parts: Sequence[Part], grid: _Grid) -> Volume:
    """Return the signed distance at each sample, negative inside, valid near the surface, `_FAR` elsewhere.

    Blends have a finite width, so a part only affects samples within that distance of its surface.

    Returns:
        Array of shape ``grid.shape``.
    """
    field = np.full(grid.shape, _FAR, np.float32)
    for part in parts:
        margin = part.blend + _MARGIN * grid.spacing + (part.ripple.height if part.ripple else 0.0)
        low, high = part.reach()
        window = grid.window(low - margin, high + margin)
        own = _part_field(part, grid, window, margin)
        before = field[window]
        if part.carve:
            field[window] = -smooth_minimum(-before, own, part.blend)
        else:
            field[window] = smooth_minimum(before, own, part.blend)
    return field


def _part_field(part: Part, grid: _Grid, window: _Window, margin: float) -> Volume:
    own = np.full([part.stop - part.start for part in window], _FAR, np.float32)
    for shape in part.shapes:
        for piece in shape.pieces(grid.spacing):
            box = _overlap(grid.window(piece.low - margin, piece.high + margin), window)
            inner = _within(box, window)
            np.minimum(own[inner], piece.distance(grid.axes(box)), out=own[inner])
    if part.ripple is not None:
        own += _ripple(grid.axes(window), part.ripple)
    return own


def _overlap(a: _Window, b: _Window) -> _Window:
    x, y, z = (slice(max(i.start, j.start), min(i.stop, j.stop)) for i, j in zip(a, b, strict=True))
    return x, y, z


def _within(box: _Window, window: _Window) -> _Window:
    x, y, z = (slice(a.start - b.start, a.stop - b.start) for a, b in zip(box, window, strict=True))
    return x, y, z


def _ripple(axes: Axes, ripple: Ripple) -> Volume:
    """Return isotropic bumps, a sum of plane waves with directions spread evenly over the sphere.

    The directions follow a Fibonacci lattice, and the wavelengths vary by half. The maximum is
    approximately the ripple's height.
    """
    turn, count = np.pi * (3 - np.sqrt(5)), 11
    total = np.zeros([axis.size for axis in axes], np.float32)
    for i in range(count):
        up = 1 - (2 * i + 1) / count
        level = np.sqrt(1 - up * up)
        number = 2 * np.pi / ripple.wavelength * (0.8 + 0.5 * (i * 0.618 % 1))
        wave = number * np.array([level * np.cos(i * turn), up, level * np.sin(i * turn)])
        phase = sum(axis * np.float32(k) for axis, k in zip(axes, wave, strict=True))
        total += np.cos(phase + np.float32(i * i))
    return total * np.float32(ripple.height / 4)
