import numpy as np
import pytest
import trimesh

from normalgan.animals.field import Part
from normalgan.animals.frames import Frame, pitch, yaw
from normalgan.animals.meshing import to_mesh
from normalgan.animals.solids import Box, Ellipsoid, Ring, Solid

TURN = yaw(35) @ pitch(-50)
AT = np.array([0.3, -0.2, 0.5])
SOLIDS = [
    (Ellipsoid(AT, np.array([0.9, 0.6, 0.4]), TURN), 4 / 3 * np.pi * 0.9 * 0.6 * 0.4),
    # A box swept by a ball: its core, six slabs, twelve quarter tubes, eight eighths of the ball.
    (
        Box(AT, np.array([0.9, 0.6, 0.5]), 0.2, TURN),
        8 * 0.7 * 0.4 * 0.3
        + 8 * 0.2 * (0.7 * 0.4 + 0.4 * 0.3 + 0.3 * 0.7)
        + 2 * np.pi * 0.04 * (0.7 + 0.4 + 0.3)
        + 4 / 3 * np.pi * 0.008,
    ),
    (Ring(AT, 0.8, 0.3, TURN), 2 * np.pi**2 * 0.8 * 0.09),
]


def sampled(solid: Solid, points: np.ndarray) -> np.ndarray:
    """Distances at scattered points, (n,)."""
    x, y, z = (points[:, i].astype(np.float32)[:, None, None] for i in range(3))
    return solid.distance(x, y, z)[:, 0, 0]


@pytest.mark.parametrize(("solid", "volume"), SOLIDS, ids=["ellipsoid", "box", "ring"])
def test_a_meshed_solid_has_its_volume_and_lies_in_its_box(solid: Solid, volume: float) -> None:
    mesh = to_mesh("solid", [Part((), 0.0, solids=(solid,))], 12_000)
    body = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    low, high = solid.reach()
    # The mesh is scaled to unit radius; its extent against that of the box gives the scale back.
    scale = float(np.max(high - low) / np.max(np.ptp(mesh.vertices, axis=0)))
    assert body.is_watertight
    assert body.volume * scale**3 == pytest.approx(volume, rel=0.03)
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0) * scale, high - low, rtol=0.03)
    assert 9_000 <= len(mesh.faces) <= 16_000


@pytest.mark.parametrize(("solid", "volume"), SOLIDS, ids=["ellipsoid", "box", "ring"])
def test_a_mirrored_or_placed_solid_is_the_same_solid_elsewhere(solid: Solid, volume: float) -> None:
    points = np.random.default_rng(0).uniform(-1.5, 1.5, (400, 3))
    own = sampled(solid, points)
    assert own.min() < 0 < own.max()
    np.testing.assert_allclose(sampled(solid.mirrored(), points * [1, 1, -1]), own, atol=1e-5)
    frame = Frame(np.array([1.0, 2.0, 3.0]), yaw(70) @ pitch(20))
    np.testing.assert_allclose(
        sampled(solid.placed(frame, 2.0), frame.place(points * 2.0)), own * 2, atol=2e-5
    )
