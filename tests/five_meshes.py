"""Five meshes of different formats."""

from pathlib import Path

import trimesh


def write_meshes(folder: Path) -> None:
    """Write five solids; none of them looks the same from all sides."""
    solids = {
        "ball.ply": trimesh.creation.icosphere(2).apply_scale([1, 0.7, 0.5]),
        "box.obj": trimesh.creation.box((1, 0.6, 0.3)),
        "can.stl": trimesh.creation.cylinder(0.4, 1.2),
        "hat.off": trimesh.creation.cone(0.5, 1.0),
        "pill.glb": trimesh.creation.capsule(1.0, 0.3),
    }
    for name, solid in solids.items():
        solid.export(folder / name)
