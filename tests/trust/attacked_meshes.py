"""Attacks on mesh files that follow the grammar of each format: all in its place, and one thing absurd."""

import base64
import json
import struct
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from hostile import FACES, PLY, TRIANGLE, gltf

MANY = 50_000
CLOUD = np.random.default_rng(0).random((48_000, 3), np.float32).tobytes()
BIG = "9" * 30
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
Tree = dict[str, Any]


def obj_attacks() -> Iterator[tuple[str, str | bytes]]:
    """Yield names and contents of OBJ files."""
    kinds = {"material": "usemtl m{}", "object": "o o{}", "group": "g g{}", "smoothing": "s {}"}
    for name, line in kinds.items():
        yield name, SQUARE + "".join(f"{line.format(i)}\nf 1 2 3\n" for i in range(MANY))
    yield "libraries", "".join(f"mtllib {i}.mtl\n" for i in range(MANY)) + SQUARE + "f 1 2 3\n"
    elsewhere = ("pipe", "zero.bin", "/dev/zero", "/etc/passwd", "../../etc/passwd", "\0", "http://[::1")
    for number, where in enumerate(elsewhere):
        yield f"library {number}", f"mtllib {where}\n{SQUARE}usemtl a\nf 1 2 3\n"
    yield "polygon", SQUARE + "f " + "1 2 3 4 " * MANY + "\n"
    yield "mixed", SQUARE + "f 1 2 3\nf 1 2 3 4\n" * MANY
    yield "indices", SQUARE + f"f 1 2 {BIG}\nf -9 -8 -7\nf 0 0 0\n"
    yield "slashes", SQUARE + "f 1/1/1 2//2 3/3\nf 1/" + "/" * MANY + " 2 3\n"
    yield "ragged", "v 0 0 0\nv 1\nv 1 0 0 1 1 1 1\nv x y z\nv nan inf 1e999\nf 1 2 3\n"
    yield "continued", SQUARE + "f 1 \\\n" * MANY + "2 3\n"
    yield "one line", SQUARE + "f 1 2 3 " * MANY
    yield "no bytes of ASCII", b"o " + b"\xe9\xff" * 500_000 + f"\n{SQUARE}f 1 2 3\n".encode()
    yield "empty faces", SQUARE + "f\n" * MANY
    yield "normals", SQUARE + "vn 0 0 1\n" * MANY + "f 1//9 2//99 3//999999\n"


def ply_attacks() -> Iterator[tuple[str, str | bytes]]:
    """Yield names and contents of PLY files."""
    sound = PLY.format("ascii", 3, 1) + FACES.format(2)
    for where in ("pipe", "zero.bin", "/dev/zero", "../x.png"):
        yield (
            f"texture {len(where)}",
            sound.replace("element v", f"comment TextureFile {where}\nelement v", 1),
        )
    yield "list", (PLY.format("ascii", 3, 1) + FACES.format(2)).replace("3 0 1 2", "2000000000 0 1 2")
    for kind, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
        head = PLY.format(kind, 3, 1).replace("uchar", "uint").encode()
        yield f"list {order}", head + TRIANGLE + struct.pack(f"{order}I3i", 2**32 - 1, 0, 1, 2)
        yield f"negative {order}", head + TRIANGLE + struct.pack(f"{order}I3i", 3, -1, -2, -3)
    yield (
        "properties",
        sound.replace(
            "element face", "".join(f"property float p{i}\n" for i in range(MANY)) + "element face", 1
        ),
    )
    yield "same property", sound.replace("property float y", "property float x", 1)
    yield "elements", sound.replace("end_header", "element none 3\n" * MANY + "end_header", 1)
    yield (
        "no properties",
        "ply\nformat ascii 1.0\nelement vertex 40\nelement face 1\nend_header\n" + "\n" * 50,
    )
    yield "kinds", sound.replace("property float x", "property quadruple x", 1)
    yield "signed count", sound.replace("vertex 3", "vertex -3", 1)
    yield "comments", sound.replace("element vertex", "comment x\n" * MANY + "element vertex", 1)
    yield "no end", sound.replace("end_header\n", "", 1)
    yield "no bytes of ASCII", sound.replace("comment", "").encode() + b"\xe9\xff" * 500_000
    yield "lists of floats", sound.replace("list uchar int", "list float double", 1)


def off_attacks() -> Iterator[tuple[str, str | bytes]]:
    """Yield names and contents of OFF files."""
    points = "0 0 0\n1 0 0\n0 1 0\n"
    yield "corners", f"OFF\n3 1 0\n{points}2000000000 0 1 2\n"
    yield "negative corners", f"OFF\n3 1 0\n{points}-3 0 1 2\n"
    yield "polygon", f"OFF\n3 1 0\n{points}{3 * MANY} " + "0 1 2 " * MANY + "\n"
    yield "mixed", f"OFF\n3 {2 * MANY} 0\n{points}" + "3 0 1 2\n4 0 1 2 0\n" * MANY
    yield "colours", f"OFF\n3 1 0\n{points}3 0 1 2 " + "0.5 " * MANY + "\n"
    yield "kinds", f"STCN4OFF\n3 1 0\n{points}3 0 1 2\n"
    yield "comments", f"OFF\n3 1 0\n{points}" + "# x\n" * MANY + "3 0 1 2\n"
    yield "no numbers", "OFF\nthree one zero\n"
    yield "numbers", f"OFF\n3 1 0\nnan inf {BIG}\n1e999 0 0\n0 1 0\n3 0 1 2\n"
    yield "no bytes of ASCII", b"OFF\n# " + b"\xe9\xff" * 500_000 + f"\n3 1 0\n{points}3 0 1 2\n".encode()
    yield "negative counts", f"OFF\n-3 -1 0\n{points}3 0 1 2\n"
    yield "digits", f"OFF\n{'9' * 5000} 1 0\n{points}3 0 1 2\n"


def embedded(data: bytes) -> Tree:
    """Return a buffer that is written into the file."""
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return {"byteLength": len(data), "uri": uri}


def vertices(count: int, **more: Any) -> Tree:
    """Return an accessor of vertices."""
    return {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": count, **more}


def rigged(change: Callable[[Tree], object]) -> str:
    """Return a triangle that hangs on two nodes, of which the second turns, with something changed."""
    tree = json.loads(gltf())
    weights = np.tile(np.array([1, 0, 0, 0], np.float32), (3, 1)).tobytes()
    times = np.array([0, 1], np.float32).tobytes()
    turns = np.array([[0, 0, 0, 1], [0, 0, 1, 0]], np.float32).tobytes()
    data = TRIANGLE + bytes(12) + weights + times + turns
    tree |= {
        "buffers": [embedded(data)],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": length}
            for start, length in ((0, 36), (36, 12), (48, 48), (96, 8), (104, 32))
        ],
        "accessors": [
            vertices(3),
            {"bufferView": 1, "componentType": 5121, "type": "VEC4", "count": 3},
            {"bufferView": 2, "componentType": 5126, "type": "VEC4", "count": 3},
            {"bufferView": 3, "componentType": 5126, "type": "SCALAR", "count": 2},
            {"bufferView": 4, "componentType": 5126, "type": "VEC4", "count": 2},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}}]}],
        "nodes": [{"children": [1]}, {}, {"mesh": 0, "skin": 0}],
        "scenes": [{"nodes": [0, 2]}],
        "skins": [{"joints": [0, 1]}],
        "animations": [
            {
                "samplers": [{"input": 3, "output": 4}],
                "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}],
            }
        ],
    }
    change(tree)
    return json.dumps(tree)


def put(*path: str | int, value: Any) -> Callable[[Tree], object]:
    """Return what puts a value in a place of a tree."""

    def change(tree: Tree) -> None:
        place: Any = tree
        for step in path[:-1]:
            place = place[step]
        place[path[-1]] = value

    return change


def repeat(count: int) -> Callable[[Tree], object]:
    """Return what has a file say that it holds a thousand times what it does, by an accessor or a view."""
    return lambda tree: tree["accessors"].extend([vertices(count)] * 1000)


GLTF: dict[str, Callable[[Tree], object]] = {
    "stride of 0": lambda tree: tree.update(
        bufferViews=[{"buffer": 0, "byteLength": 36, "byteStride": 0}], accessors=[vertices(2**23)]
    ),
    "stride of 1": put("bufferViews", 0, "byteStride", value=1),
    "negative stride": put("bufferViews", 0, "byteStride", value=-12),
    "stride of joints": put("bufferViews", 1, "byteStride", value=0),
    "many numbers": repeat(10**6),
    "many views": lambda tree: tree.update(
        buffers=[embedded(bytes(2**20))], bufferViews=[{"buffer": 0, "byteLength": 2**20}] * 4000
    ),
    "many zeros": lambda tree: tree["accessors"].extend(
        [{"componentType": 5126, "type": "MAT4", "count": 2**20}] * 3
    ),
    "a part repeated": lambda tree: tree.update(
        buffers=[embedded(bytes(600_000))],
        bufferViews=[{"buffer": 0, "byteLength": 600_000}],
        accessors=[vertices(50_000)],
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}}]}],
        nodes=[{"mesh": 0}] * 4000,
        scenes=[{"nodes": list(range(4000))}],
        skins=[],
        animations=[],
    ),
    "a part repeated less": lambda tree: tree.update(
        buffers=[embedded(CLOUD)],
        bufferViews=[{"buffer": 0, "byteLength": len(CLOUD)}],
        accessors=[vertices(len(CLOUD) // 12)],
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}}]}],
        nodes=[{"mesh": 0, "translation": [i, 0, 0]} for i in range(5)],
        scenes=[{"nodes": list(range(5))}],
        skins=[],
        animations=[],
    ),
    "a thousand parts": lambda tree: tree.update(
        buffers=[embedded(CLOUD)],
        bufferViews=[{"buffer": 0, "byteLength": len(CLOUD)}],
        accessors=[vertices(240)],
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}}]}],
        nodes=[{"mesh": 0, "translation": [i, 0, 0]} for i in range(1000)],
        scenes=[{"nodes": list(range(1000))}],
        skins=[],
        animations=[],
    ),
    "points in one place": lambda tree: tree.update(
        buffers=[embedded(bytes(len(CLOUD)))],
        bufferViews=[{"buffer": 0, "byteLength": len(CLOUD)}],
        accessors=[vertices(len(CLOUD) // 12)],
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}}]}],
        nodes=[{"mesh": 0}, {"mesh": 0}],
        scenes=[{"nodes": [0, 1]}],
        skins=[],
        animations=[],
    ),
    "zeros": lambda tree: tree.update(
        accessors=[
            {"componentType": code, "type": kind, "count": 3 * 2**16}
            for code, kind in ((5126, "VEC3"), (5121, "VEC4"), (5126, "VEC4"))
        ],
        animations=[],
    ),
    "a long chain": lambda tree: tree.update(
        nodes=[{"children": [i + 1]} for i in range(4998)] + [{"mesh": 0}],
        scenes=[{"nodes": [0]}],
        skins=[],
        animations=[],
    ),
    "its own ancestor": put("nodes", 1, "children", value=[0]),
    "negative counts": put("accessors", 0, "count", value=-3),
    "count of half": put("accessors", 0, "count", value=2.5),
    "count as text": put("accessors", 0, "count", value="3"),
    "count beyond floats": put("accessors", 0, "count", value=10**400),
    "no such component": put("accessors", 0, "componentType", value=9),
    "no such type": put("accessors", 0, "type", value="VEC9"),
    "negative view": put("accessors", 0, "bufferView", value=-1),
    "negative offset": put("bufferViews", 0, "byteOffset", value=-36),
    "offset beyond": put("accessors", 0, "byteOffset", value=10**12),
    "length beyond": put("bufferViews", 0, "byteLength", value=10**12),
    "buffer beyond": put("buffers", 0, "byteLength", value=10**15),
    "no base64": put("buffers", 0, "uri", value="data:;base64,????"),
    "a pipe": put("buffers", 0, "uri", value="pipe"),
    "a device": put("buffers", 0, "uri", value="zero.bin"),
    "sparse": put(
        *("accessors", 0, "sparse"),
        value={
            "count": 10**9,
            "indices": {"bufferView": 0, "componentType": 5125},
            "values": {"bufferView": 0},
        },
    ),
    "indices of floats": put("meshes", 0, "primitives", 0, "indices", value=0),
    "indices of weights": put("meshes", 0, "primitives", 0, "indices", value=3),
    "a strip": put("meshes", 0, "primitives", 0, "mode", value=5),
    "no such mode": put("meshes", 0, "primitives", 0, "mode", value=99),
    "scale beyond": put("nodes", 0, "scale", value=[1e300, 1e300, 1e300]),
    "matrix of text": put("nodes", 0, "matrix", value="x" * 16),
    "matrix beyond": put("nodes", 2, "matrix", value=[1e308] * 16),
    "many joints": put("skins", 0, "joints", value=[0, 1] * MANY),
    "no such joint": put("skins", 0, "joints", value=[10**30]),
    "many clips": lambda tree: tree.update(animations=tree["animations"] * MANY),
    "many channels": lambda tree: tree["animations"][0].update(
        channels=tree["animations"][0]["channels"] * MANY
    ),
    "many sets": lambda tree: tree["meshes"][0]["primitives"][0]["attributes"].update(
        {f"{name}_{k}": 1 + (name == "WEIGHTS") for name in ("JOINTS", "WEIGHTS") for k in range(1000)}
    ),
    "clips of many nodes": lambda tree: tree.update(
        nodes=tree["nodes"] + [{}] * 4000, animations=tree["animations"] * 1000
    ),
    "times beyond": put("accessors", 3, "count", value=2**23),
    "pictures": lambda tree: tree.update(
        images=[{"uri": "/dev/zero"}, {"uri": "pipe"}],
        textures=[{"source": 0}, {"source": 1}],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 1}}}],
    ),
    "draco": put(
        *("meshes", 0, "primitives", 0, "extensions"),
        value={"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}},
    ),
    "a name that says more": put("nodes", 0, "name", value="\x1b[2J" * 1000),
}
"""What is done to a small rig: each must be read or refused."""


REFUSED = {
    "stride of 0.gltf": "has elements of 12 bytes 0 bytes apart, in accessor 0",
    "many numbers.gltf": "declares 3000000043 numbers, more than a mesh file can hold",
    "many views.gltf": "refers to the same bytes again and again",
    "a part repeated.gltf": "places 200000000 vertices; reduce it to",
    "a pipe.gltf": "refers to 'pipe', which is not a file",
    "a device.gltf": "refers to 'zero.bin', which is not a file",
}
"""What is said of some."""
REFUSED_RIGS = {
    "many clips.gltf": "it has 50000 animations of 50000 channels; delete most of them",
    "many channels.gltf": "it has 1 animations of 50000 channels",
    "clips of many nodes.gltf": "it has 1000 animations of 1000 channels",
    "a thousand parts.gltf": "its 240000 vertices hang on 1000 loose trees of nodes; join them",
    "many sets.gltf": "a vertex is bound to 4000 joints; 16 are enough",
}
"""The same of rigs."""
READ = dict.fromkeys(("material.obj", "libraries.obj", "library 0.obj", "library 2.obj"), "")
"""What these refer to is not needed."""


def attacked_rigs() -> dict[str, tuple[str | bytes, str | None]]:
    """Return the contents of attacked rigs by name, and what is said of them if that is known."""
    said = REFUSED | REFUSED_RIGS
    return {f"{name}.gltf": (rigged(change), said.get(f"{name}.gltf")) for name, change in GLTF.items()}


def attacked_meshes() -> dict[str, tuple[str | bytes, str | None]]:
    """Return the same of files of every format, as meshes."""
    formats = {"obj": obj_attacks(), "ply": ply_attacks(), "off": off_attacks()}
    found = {f"{name}.{suffix}": content for suffix, made in formats.items() for name, content in made}
    found |= {name: content for name, (content, _) in attacked_rigs().items()}
    return {name: (content, (REFUSED | READ).get(name)) for name, content in found.items()}
