"""Checks of a renderer."""

from collections.abc import Iterator

import numpy as np

from normalgan.normals import angles
from normalgan.rendering.cameras import Camera
from normalgan.rendering.maps import Maps, check_maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers import Renderer
from normalgan.testing.conformance import (
    Check,
    demand,
    global_randomness_untouched,
    held_to_contract,
    promised,
)
from normalgan.testing.settings import frozen_check, settings_checks
from normalgan.testing.solids import RADII, away, bowl, camera, ellipsoid, exact_ellipsoid

_MAPS = promised(Renderer.render)
_SIZE = 96
_VIEWS = {"orthographic": None, "perspective": 40.0}
"""Tested fields of view in degrees."""


def renderer_checks() -> list[Check[Renderer]]:
    """Return the named checks of a renderer, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(Renderer),  # type: ignore[type-abstract]
        frozen_check(),
        Check("running here", lambda r: r.check(), "check must pass where the renderer can be used"),
        Check("shapes and types", _shapes, _MAPS),
        Check("unit normals on the object", _unit, _MAPS),
        Check("nothing outside the object", _background, _MAPS),
        Check("the mask of an ellipsoid", _mask, _MAPS),
        Check("the normals of an ellipsoid", _normals, _MAPS),
        Check("the depth of an ellipsoid", _depth, _MAPS),
        Check("the inside of an open shell", _inside, _MAPS),
        Check("an empty view", _empty, "a frame without the object must give empty maps"),
        Check("the same maps again", _repeats, _MAPS),
        Check("no use of global randomness", _no_global, "it must not draw random numbers"),
    ]


def _render(renderer: Renderer, mesh: Mesh, seen_by: Camera, size: int = _SIZE) -> Maps:
    with held_to_contract():
        return check_maps(renderer, renderer.render(mesh, seen_by, size), size)


def _shapes(renderer: Renderer) -> None:
    for size in (33, 64):
        maps = _render(renderer, ellipsoid(), camera(ellipsoid()), size)
        for name in ("normal", "depth"):
            dtype = getattr(maps, name).dtype
            demand(dtype == np.float32, renderer, f"gave a {name} of {dtype}", "it must be float32")


def _unit(renderer: Renderer) -> None:
    maps = _render(renderer, ellipsoid(), camera(ellipsoid()))
    demand(
        maps.mask.any(),
        renderer,
        "renders nothing of an ellipsoid in the frame",
        "the mask must be True on the object",
    )
    length = np.linalg.norm(maps.normal[maps.mask], axis=-1)
    off = float(np.abs(length - 1).max())
    asked = "normals on the object must be unit vectors, not blended with the background"
    demand(off < 1e-3, renderer, f"rendered a normal with a length that is {off:.2g} off", asked)


def _background(renderer: Renderer) -> None:
    maps = _render(renderer, ellipsoid(), camera(ellipsoid()))
    demand(
        not maps.normal[~maps.mask].any(),
        renderer,
        "rendered normals outside the object",
        "they must be zero there",
    )
    good = bool(np.isposinf(maps.depth[~maps.mask]).all())
    demand(good, renderer, "has a finite depth outside the object", "it must be infinite there")


def _ellipsoids(renderer: Renderer) -> Iterator[tuple[str, Maps, Maps]]:
    """Yield the name of each projection, with the rendered and the exact maps of an ellipsoid."""
    for projection, field_of_view in _VIEWS.items():
        seen_by = camera(ellipsoid(), field_of_view)
        yield projection, _render(renderer, ellipsoid(), seen_by), exact_ellipsoid(RADII, seen_by, _SIZE)


def _mask(renderer: Renderer) -> None:
    for projection, maps, true in _ellipsoids(renderer):
        share = int((maps.mask & true.mask).sum()) / max(int((maps.mask | true.mask).sum()), 1)
        did = f"has an IoU of {share:.0%} with the true {projection} mask of an ellipsoid"
        asked = "the object must be where the camera's window shows it, sampled at pixel centres"
        demand(share > 0.98, renderer, did, asked)


def _normals(renderer: Renderer) -> None:
    for projection, maps, true in _ellipsoids(renderer):
        both = maps.mask & true.mask
        error = float(angles(maps.normal[both], true.normal[both]).mean()) if both.any() else np.nan
        did = f"is {error:.1f}° off from the true {projection} normals of an ellipsoid"
        asked = "normals are in camera space, x to the right, y up and z to the viewer, row 0 on top"
        demand(error < 1, renderer, did, asked)


def _depth(renderer: Renderer) -> None:
    for projection, maps, true in _ellipsoids(renderer):
        both = maps.mask & true.mask
        error = float(np.median(np.abs(maps.depth[both] - true.depth[both]))) if both.any() else np.nan
        did = f"is {error:.3g} off from the true {projection} depth of an ellipsoid"
        asked = "depth is the distance from the camera's plane along its axis, in units of the mesh"
        demand(error < 5e-3, renderer, did, asked)


def _inside(renderer: Renderer) -> None:
    for field_of_view in _VIEWS.values():
        seen_by = camera(bowl(), field_of_view, front=True)
        maps = _render(renderer, bowl(), seen_by)
        sight = seen_by.rays(_SIZE)[1] @ seen_by.rotation.T
        away_share = float(((maps.normal * sight).sum(-1)[maps.mask] > 0.05).mean())
        did = f"has {away_share:.0%} of the normals of an open shell facing away from the viewer"
        asked = "a surface seen from behind must have normals that face the viewer"
        demand(away_share < 0.02, renderer, did, asked)


def _empty(renderer: Renderer) -> None:
    maps = _render(renderer, ellipsoid(), away(ellipsoid()))
    nothing = not maps.mask.any() and not maps.normal.any()
    demand(nothing, renderer, "rendered something in a frame without the object", "the maps must be empty")


def _repeats(renderer: Renderer) -> None:
    # Other meshes and sizes in between, because a renderer may keep state between calls.
    first = _render(renderer, ellipsoid(), camera(ellipsoid()))
    _render(renderer, bowl(), camera(bowl()), 40)
    again = _render(renderer, ellipsoid(), camera(ellipsoid()))
    same = all(np.array_equal(getattr(first, n), getattr(again, n)) for n in ("normal", "depth", "mask"))
    demand(
        same,
        renderer,
        "rendered the same view twice with different results",
        "samples are cached by their settings only",
    )


def _no_global(renderer: Renderer) -> None:
    with global_randomness_untouched(renderer):
        _render(renderer, ellipsoid(), camera(ellipsoid()))
