import numpy as np
from sound import check_closed

from normalgan.animals.meshing import to_mesh
from normalgan.animals.objects import turned
from normalgan.animals.parts import Part, ball


def test_a_turned_vessel_is_open_and_as_thick_as_its_wall() -> None:
    mesh = to_mesh("pot", turned([0.0, 0.05, 0.5, 1.0], [0.3, 0.3, 0.3, 0.3], 0.06), 20_000)
    body = check_closed(mesh)
    # A tube of constant width with a floor: its volume follows from the wall.
    height = np.ptp(mesh.vertices[:, 1])
    scale = height / 1.0
    outer = np.pi * 0.3**2 * 1.0
    inner = np.pi * 0.24**2 * 1.0
    assert outer - inner < body.volume / scale**3 < 0.55 * outer
    # Straight down into it, the first thing met is deep below the rim.
    top = mesh.vertices[:, 1].max()
    axis = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 2]) < 0.05
    floor = mesh.vertices[axis, 1].max()
    assert top - floor > 0.7 * height


def test_hollow_and_nested_bodies_get_the_faces_asked_for() -> None:
    nested = [Part(tuple(ball([0.1 * i, 0, 0], 1.0) for i in range(6)), 0.0)]
    for parts in (turned([0.0, 0.05, 0.5, 1.0], [0.3, 0.3, 0.3, 0.3], 0.06), nested):
        assert 14_000 <= len(to_mesh("body", parts, 20_000).faces) <= 26_000
