import base64
import json
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mesh_shapes import trimesh

from normalgan.errors import InputError
from normalgan.rendering.loading import read_triangles
from normalgan.rendering.mesh_files import MeshFile

U = [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]
"""The outline of a U of seven unit squares, counter-clockwise."""
ARROW = [(0, 0), (4, -4), (0, 4), (-4, -4)]
"""A quadrilateral whose first corner turns inwards; it has an area of 16."""
Points = list[tuple[float, float, float]]
Faces = list[list[int]]


def prism(outline: Sequence[tuple[float, float]]) -> tuple[Points, Faces]:
    """Return a prism of height 1 whose top and bottom are one face each."""
    n = len(outline)
    points = [(float(x), float(y), z) for z in (0.0, 1.0) for x, y in outline]
    sides = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return points, [[*range(n)][::-1], [*range(n, 2 * n)], *sides]


def obj(points: Points, faces: Faces) -> bytes:
    lines = [f"v {x} {y} {z}" for x, y, z in points]
    lines += ["f " + " ".join(f"{i + 1}/1/1" for i in face) for face in faces]
    return "\n".join(["# by hand", "o thing", *lines, ""]).encode()


def obj_backwards(points: Points, faces: Faces) -> bytes:
    """Return an OBJ whose faces count back from the last vertex, with lines that go on in the next."""
    lines = [f"v {x} {y} {z} 0.5 0.5 0.5" for x, y, z in points]
    lines += ["f " + " \\\n".join(str(i - len(points)) for i in face) + " # a face" for face in faces]
    return "\r\n".join(lines).encode()


def off(points: Points, faces: Faces) -> bytes:
    lines = [f"{x} {y} {z} 255 0 0 255" for x, y, z in points]
    lines += [" ".join(map(str, [len(face), *face, 9, 9, 9])) for face in faces]
    return "\n".join(["COFF # colours", f"{len(points)} {len(faces)} 0", "", *lines]).encode()


def ply(points: Points, faces: Faces, order: str) -> bytes:
    head = "\n".join(
        [
            *("ply", f"format {order} 1.0", "comment by hand", f"element vertex {len(points)}"),
            *("property float x", "property float y", "property double z", f"element face {len(faces)}"),
            *("property uchar flags", "property list uchar uint vertex_indices", "end_header\n"),
        ]
    )
    if order == "ascii":
        rows = [*points, *([7, len(face), *face] for face in faces)]
        return (head + "\n".join(" ".join(map(str, row)) for row in rows)).encode()
    mark = "<" if "little" in order else ">"
    body = b"".join(struct.pack(f"{mark}ffd", *point) for point in points)
    for face in faces:
        body += struct.pack(f"{mark}BB{len(face)}I", 7, len(face), *face)
    return head.encode() + body


WRITERS: dict[str, Callable[[Points, Faces], bytes]] = {
    "plain.obj": obj,
    "backwards.obj": obj_backwards,
    "utf-16.obj": lambda points, faces: obj(points, faces).decode().encode("utf-16"),
    "utf-8.obj": lambda points, faces: b"\xef\xbb\xbf" + obj(points, faces),
    "old_mac.obj": lambda points, faces: obj(points, faces).replace(b"\n", b"\r"),
    "colours.off": off,
    "utf-16.off": lambda points, faces: ("\ufeff" + off(points, faces).decode()).encode("utf-16-be"),
    "text.ply": lambda points, faces: ply(points, faces, "ascii"),
    "utf-16.ply": lambda points, faces: ply(points, faces, "ascii").decode().encode("utf-16"),
    "little.ply": lambda points, faces: ply(points, faces, "binary_little_endian"),
    "big.ply": lambda points, faces: ply(points, faces, "binary_big_endian"),
}


@pytest.mark.parametrize("turn", [0.0, 0.7])
@pytest.mark.parametrize("name", WRITERS)
def test_concave_faces_leave_out_what_their_outline_does(tmp_path: Path, name: str, turn: float) -> None:
    for outline, area in ((U, 7.0), (ARROW, 16.0)):
        points, faces = prism(outline)
        tilt = trimesh.transformations.euler_matrix(turn, 2 * turn, -turn)[:3, :3]
        points = [(float(x), float(y), float(z)) for x, y, z in np.array(points) @ tilt]
        (tmp_path / name).write_bytes(WRITERS[name](points, faces))
        solid = trimesh.Trimesh(*read_triangles(tmp_path / name), process=False)
        assert solid.volume == pytest.approx(area, rel=1e-5)
        if "mac" not in name:
            solid.merge_vertices()
            assert solid.is_watertight
            assert solid.is_winding_consistent


def test_a_mesh_for_training_has_the_notch_of_a_u(tmp_path: Path) -> None:
    (tmp_path / "u.obj").write_bytes(obj(*prism(U)))
    mesh = MeshFile(str(tmp_path / "u.obj")).load()
    body = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    box = np.prod(np.ptp(mesh.vertices, axis=0))
    assert body.volume == pytest.approx(box * 7 / 9, rel=1e-4)


def test_faces_alike_and_faces_mixed_of_a_binary_ply_are_the_same(tmp_path: Path) -> None:
    points, faces = prism(U[:4])
    quads = [[*face] for face in faces]
    split = [*quads[:-1], quads[-1][:3], [quads[-1][i] for i in (0, 2, 3)]]
    meshes = []
    for name, given in (("alike", quads), ("mixed", split)):
        (tmp_path / f"{name}.ply").write_bytes(ply(points, given, "binary_little_endian"))
        meshes.append(read_triangles(tmp_path / f"{name}.ply"))
    for one, other in zip(*meshes, strict=True):
        np.testing.assert_array_equal(one, other)


def gltf(
    mode: int, indices: Sequence[int] | None, change: Callable[[Any], None] = lambda tree: None
) -> bytes:
    """Return a glTF of a hexagon about its middle, counter-clockwise from the right."""
    around = [(np.cos(a), np.sin(a), 0.0) for a in np.linspace(0, 2 * np.pi, 7)]
    points = np.array([(0.0, 0.0, 0.0), *around], np.float32)
    data = points.tobytes() + np.array(indices or [], np.uint16).tobytes()
    views = [{"buffer": 0, "byteLength": points.nbytes}]
    accessors: list[dict[str, Any]] = [
        {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": len(points)}
    ]
    part: dict[str, Any] = {"attributes": {"POSITION": 0}, "mode": mode}
    if indices:
        views.append({"buffer": 0, "byteOffset": points.nbytes, "byteLength": 2 * len(indices)})
        accessors.append({"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": len(indices)})
        part["indices"] = 1
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    tree: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": uri, "byteLength": len(data)}],
        **{"bufferViews": views, "accessors": accessors, "meshes": [{"primitives": [part]}]},
        **{"nodes": [{"mesh": 0, "scale": [2, 1, 1]}], "scenes": [{"nodes": [0]}], "scene": 0},
    }
    if change is not None:
        change(tree)
    return json.dumps(tree).encode()


HEXAGON = 3 * np.sqrt(3)
"""The area of the hexagon, twice as wide as it is high."""


@pytest.mark.parametrize(
    ("mode", "indices"),
    [
        (6, None),
        (6, [0, 1, 2, 3, 4, 5, 6, 7]),
        (5, [1, 2, 6, 3, 5, 4]),
        (4, [0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 6, 0, 6, 1]),
    ],
)
def test_fans_strips_and_lists_of_gltf_are_faces(
    tmp_path: Path, mode: int, indices: Sequence[int] | None
) -> None:
    (tmp_path / "hexagon.gltf").write_bytes(gltf(mode, indices))
    vertices, faces = read_triangles(tmp_path / "hexagon.gltf")
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    area = np.cross(b - a, c - a) / 2
    np.testing.assert_allclose(area.sum(axis=0), [0, 0, HEXAGON], atol=1e-5)


def put(*path: str | int, value: Any) -> Callable[[Any], None]:
    def change(tree: Any) -> None:
        for step in path[:-1]:
            tree = tree[step]
        tree[path[-1]] = value

    return change


SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
TRIANGLE = "3 1 0\n0 0 0\n1 0 0\n0 1 0\n"
PLY = ply(*prism(U), "ascii").decode()
BAD: dict[str, tuple[bytes | str, str]] = {
    "beyond.obj": (SQUARE + "f 1 2 9\n", "a face refers to a missing vertex"),
    "zero.obj": (SQUARE + "f 0 1 2\n", "a face refers to vertex 0, which is missing; OBJ counts from 1"),
    "before.obj": (SQUARE + "f -1 -2 -9\n", "a face refers to vertex -9, which is missing"),
    "words.obj": (SQUARE + "f one two three\n", "'f one two three' is not a face"),
    "short.obj": ("v 0 0\n" + SQUARE + "f 1 2 3\n", "'v 0 0' is not a vertex, which has three numbers"),
    "letters.obj": ("v 0 0 x\n" + SQUARE + "f 1 2 3\n", "'v 0 0 x' is not a vertex"),
    "huge.obj": (SQUARE + f"f 1 2 {10**30}\n", "a face refers to a missing vertex"),
    "edges.obj": (SQUARE + "f 1 2\nl 1 2 3\n", "holds no faces"),
    "corners.off": (f"OFF\n{TRIANGLE}2000000000 0 1 2\n", "a face declares 2000000000 corners and lists 3"),
    "negative.off": (f"OFF\n{TRIANGLE}-3 0 1 2\n", "a face declares -3 corners"),
    "kind.off": (f"4OFF\n{TRIANGLE}3 0 1 2\n", "an OFF of the kind 4OFF; OFF, COFF and NOFF as text"),
    "binary.off": (f"OFF BINARY\n{TRIANGLE}3 0 1 2\n", "OFF BINARY; OFF, COFF"),
    "cut.off": (f"OFF\n{TRIANGLE}", "declares 3 vertices and 1 faces in 3 lines (is it truncated"),
    "corners.ply": (PLY.replace("\n7 8 ", "\n7 2000000000 ", 1), "declares 2000000000 corners and lists 8"),
    "axes.ply": (PLY.replace("property float y", "property float w"), "its vertices have no x, y and z"),
    "header.ply": (PLY.replace("property float y", "property quad y"), "has the line 'property quad y'"),
    "cut.ply": (ply(*prism(U), "binary_big_endian")[:-3], "and it ends before"),
    "none.gltf": (gltf(6, None, put("meshes", 0, value=7)), "it does not conform to glTF 2.0"),
    "strange.gltf": (gltf(6, None, put("nodes", 0, "mesh", value="a")), "refers to entry a of its 1 meshes"),
}


@pytest.mark.parametrize("name", BAD)
def test_errors_describe_the_file_and_not_the_parser(tmp_path: Path, name: str) -> None:
    content, sentence = BAD[name]
    (tmp_path / name).write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(InputError) as refused:
        read_triangles(tmp_path / name)
    said = str(refused.value)
    assert sentence in said
    assert "Error" not in said
    assert said.endswith(".")
    assert said.startswith(str(tmp_path / name))


def test_extensions_that_alter_no_surface_are_passed_over(tmp_path: Path) -> None:
    needed = ["KHR_texture_transform", "KHR_mesh_quantization", "KHR_materials_unlit"]
    (tmp_path / "a.gltf").write_bytes(gltf(6, None, put("extensionsRequired", value=needed)))
    assert len(read_triangles(tmp_path / "a.gltf")[1]) == 6
