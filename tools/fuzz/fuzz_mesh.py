"""Fuzz target: meshes, in the format that their first bytes are of, and rigs."""

import harness

with harness.instrumented("trimesh"):
    import trimesh  # noqa: F401

    from normalgan.rendering.mesh_files import MeshFile
    from normalgan.rendering.rigs import RiggedFile, find_poses

STARTS = {b"OFF": "off", b"ply": "ply", b"solid": "stl", b"glTF": "glb", b"{": "gltf", b"\0": "stl"}
"""Beginnings of files, and what a user would call such a file; anything else is an OBJ."""


def read(data: bytes) -> None:
    """Read a mesh as rendering does, its fingerprint first, and a glTF as a rig too."""
    kind = next((kind for start, kind in STARTS.items() if data.startswith(start)), "obj")
    file = MeshFile(str(harness.as_file(data, f"mesh.{kind}")))
    with harness.refusals():
        file.fingerprint()
        mesh = file.load()
        assert mesh.faces.max() < len(mesh.vertices)
    if kind in {"glb", "gltf"}:
        with harness.refusals():
            find_poses([file], 1)
            RiggedFile(file, 0).load()


if __name__ == "__main__":
    harness.run(read)
