"""Hostile files: small to make, and asking for all memory, all time, or somebody else's files."""

import json
import struct
from typing import Any

BILLION = 10**9
TRIANGLE = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
OFF = "OFF\n{} {} 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 {}\n"
PLY = (
    "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
    "element face {}\nproperty list uchar int vertex_indices\nend_header\n"
)
FACES = "0 0 0\n1 0 0\n0 1 0\n3 0 1 {}\n"
ACCESSOR = {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}


def gltf(**entries: Any) -> str:
    """Return a glTF file of one triangle in ``triangle.bin``, some of its entries put in place of others."""
    tree: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [ACCESSOR],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "triangle.bin"}],
    }
    return json.dumps(tree | entries)


def elsewhere(uri: str) -> str:
    """Return a glTF file whose numbers lie under a URI."""
    return gltf(buffers=[{"byteLength": 36, "uri": uri}])


MESHES: dict[str, tuple[str | bytes, str]] = {
    "vertices.off": (OFF.format(BILLION, 1, 2), "declares 1000000000 vertices and 1 faces in"),
    "faces.off": (OFF.format(3, BILLION, 2), "declares 3 vertices and 1000000000 faces in"),
    "index.off": (OFF.format(3, 1, BILLION), "cannot be read as a mesh"),
    "vertices.ply": (PLY.format("ascii", BILLION, 1) + FACES.format(2), "of 1000000000 elements"),
    "faces.ply": (PLY.format("ascii", 3, BILLION) + FACES.format(2), "of 1000000000 elements"),
    "index.ply": (PLY.format("ascii", 3, 1) + FACES.format(BILLION), "refers to a missing vertex"),
    "binary.ply": (
        PLY.format("binary_little_endian", BILLION, 1).encode() + TRIANGLE,
        "declares 1000000000 elements in fewer bytes",
    ),
    "index.obj": (f"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {BILLION}\n", "cannot be read as a mesh"),
    "count.stl": (b"\0" * 80 + struct.pack("<I", BILLION) + b"\0" * 50, "holds no faces"),
    "above.gltf": (elsewhere("../../etc/passwd"), "is not in its folder"),
    "escaped.gltf": (elsewhere("%2e%2e/triangle.bin"), "is not in its folder"),
    "absolute.gltf": (elsewhere("/etc/passwd"), "is not in its folder"),
    "endless.gltf": (elsewhere("/dev/zero"), "is not in its folder"),
    "network.gltf": (elsewhere("http://127.0.0.1:9/triangle.bin"), "is not in its folder"),
    "scheme.gltf": (elsewhere("file:///etc/passwd"), "is not in its folder"),
    "link.gltf": (elsewhere("zero.bin"), "which is not a file"),
    "count.gltf": (gltf(accessors=[{**ACCESSOR, "count": BILLION}]), "declares 3000000000 numbers"),
    "zeros.gltf": (
        gltf(accessors=[{"componentType": 5126, "type": "VEC3", "count": BILLION}]),
        "declares 3000000000 numbers",
    ),
    "stride.gltf": (
        gltf(bufferViews=[{"buffer": 0, "byteLength": 36, "byteStride": BILLION}]),
        "cannot be read as a mesh",
    ),
    "nodes.gltf": (
        gltf(nodes=[{"mesh": 0}] * 200_000, scenes=[{"nodes": list(range(200_000))}]),
        "places 200000 parts",
    ),
    "parts.gltf": (
        gltf(meshes=[{"primitives": [{"attributes": {"POSITION": 0}}] * 100_000}]),
        "places 100000 parts",
    ),
    "deep.gltf": ('{"a":' + "[" * 200_000 + "]" * 200_000 + "}", "nested more deeply"),
}
"""Meshes, each with a part of the sentence that refuses it."""


def laughs(levels: int) -> str:
    """Return lists of lists: ten aliases of the level below in each."""
    lines = [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, levels + 1)]
    return "\n".join(["a0: &a0 [x, x]", *lines, ""])


CONFIGURATIONS: dict[str, tuple[str | bytes, str]] = {
    "laughs.yaml": (laughs(11), "stands for more than 100000 values"),
    "section.yaml": (laughs(8) + "data: *a8\n", "stands for more than 100000 values"),
    "itself.yaml": ("data: &a [1, *a]\n", "contains itself, at *a"),
    "deep.yaml": ("data: " + "[" * 100_000 + "]" * 100_000, "is nested more than 50 deep"),
    "blocks.yaml": ("".join(f"{' ' * i}a:\n" for i in range(400)), "is nested more than 50 deep"),
    "long.yaml": ("data: {}\n" + "# more\n" * 100_000, "has more than 262144 bytes"),
    "call.yaml": ("data: !!python/object/apply:os.system ['touch touched']\n", "is not YAML"),
}

PLANS: dict[str, tuple[str | bytes, str]] = {
    "rows.yaml": (laughs(8) + "name: bomb\nimages: 1\nrows: *a8\n", "stands for more than 100000 values"),
    "deep.yaml": ("rows: " + "[" * 100_000 + "]" * 100_000, "is nested more than 50 deep"),
    "long.yaml": ("rows: []\n" + "# more\n" * 100_000, "has more than 262144 bytes"),
    "itself.yaml": ("rows: &a [*a]\n", "contains itself, at *a"),
    "call.yaml": ("rows: !!python/object/apply:os.system ['touch touched']\n", "is not YAML"),
}

ORIENTATIONS: dict[str, tuple[str | bytes, str]] = {
    "deep.json": ("[" * 200_000 + "]" * 200_000, "is not JSON"),
    "digits.json": ("1" * 100_000, "is not JSON"),
}
