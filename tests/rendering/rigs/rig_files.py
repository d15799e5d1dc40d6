"""Small rigs written as glTF by hand: a bar on two bones, bent in its middle."""

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

CODES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
KINDS = {(): "SCALAR", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
QUARTER = np.array([0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)])  # 90° about z
RINGS = 21


class Gltf:
    """A glTF file in the making; its numbers lie in one buffer, written into it as base64."""

    def __init__(self) -> None:
        self.tree: dict[str, Any] = {"asset": {"version": "2.0"}, "bufferViews": [], "accessors": []}
        self.data = bytearray()

    def view(self, values: NDArray[Any], **more: Any) -> int:
        self.data += bytes(-len(self.data) % 4)
        raw = np.ascontiguousarray(values).tobytes()
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw), **more}
        self.tree["bufferViews"].append(view)
        self.data += raw
        return len(self.tree["bufferViews"]) - 1

    def accessor(self, values: NDArray[Any], **more: Any) -> int:
        # Matrices lie column by column.
        stored = values.transpose(0, 2, 1) if values.ndim == 3 else values
        entry = {
            "bufferView": self.view(stored),
            "componentType": CODES[values.dtype.str[1:]],
            "count": len(values),
            "type": KINDS[values.shape[1:]],
            **more,
        }
        self.tree["accessors"].append(entry)
        return len(self.tree["accessors"]) - 1

    def finished(self) -> dict[str, Any]:
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return {**self.tree, "buffers": [{"byteLength": len(self.data), "uri": uri}]}


def tube() -> tuple[NDArray[np.float32], NDArray[np.uint16]]:
    """A closed square bar along y from 0 to 2, 0.2 thick: vertices ring by ring, then the faces."""
    corners = np.array([[0.1, 0.1], [-0.1, 0.1], [-0.1, -0.1], [0.1, -0.1]])
    heights = np.linspace(0, 2, RINGS)
    vertices = np.array([[x, y, z] for y in heights for x, z in corners], dtype=np.float32)
    faces = [[0, 1, 2], [0, 2, 3]]
    for ring in range(RINGS - 1):
        for side in range(4):
            a, b = 4 * ring + side, 4 * ring + (side + 1) % 4
            faces += [[a, a + 4, b], [b, a + 4, b + 4]]
    top = 4 * (RINGS - 1)
    faces += [[top, top + 2, top + 1], [top, top + 3, top + 2]]
    return vertices, np.array(faces, dtype=np.uint16)


def bar(weights: str = "f4", joints: str = "u2", clips: bool = True) -> tuple[Gltf, dict[str, Any]]:
    """A bar whose upper half hangs on the second of two bones, which a clip turns by 90° in a second.

    Returns:
        The file and its mesh's only primitive, to be changed by a test.
    """
    gltf = Gltf()
    vertices, faces = tube()
    share = np.zeros((len(vertices), 4))
    share[:, 1] = vertices[:, 1] > 1.01
    share[:, 0] = 1 - share[:, 1]
    bound = np.zeros((len(vertices), 4), dtype=joints)
    bound[:, 1] = 1
    if weights != "f4":
        share = np.rint(share * np.iinfo(weights).max)
    inverse = np.broadcast_to(np.eye(4), (2, 4, 4)).astype(np.float32).copy()
    inverse[1, 1, 3] = -1.0
    primitive = {
        "attributes": {
            "POSITION": gltf.accessor(vertices),
            "JOINTS_0": gltf.accessor(bound),
            "WEIGHTS_0": gltf.accessor(share.astype(weights), normalized=weights != "f4"),
        },
        "indices": gltf.accessor(faces.ravel()),
    }
    gltf.tree |= {
        "meshes": [{"primitives": [primitive]}],
        # The place of the node that a skinned mesh hangs on does not matter.
        "nodes": [
            {"children": [1]},
            {"translation": [0, 1, 0]},
            {"mesh": 0, "skin": 0, "translation": [5, 5, 5]},
        ],
        "skins": [{"joints": [0, 1], "inverseBindMatrices": gltf.accessor(inverse)}],
        "scenes": [{"nodes": [0, 2]}],
        "scene": 0,
    }
    if clips:
        turns = np.array([[0, 0, 0, 1], QUARTER], dtype=np.float32)
        sampler = {"input": gltf.accessor(np.array([0, 1], dtype=np.float32)), "output": gltf.accessor(turns)}
        channel = {"sampler": 0, "target": {"node": 1, "path": "rotation"}}
        gltf.tree["animations"] = [{"name": "bow", "samplers": [sampler], "channels": [channel]}]
    return gltf, primitive


def write_gltf(path: Path, gltf: Gltf) -> Path:
    path.write_text(json.dumps(gltf.finished()))
    return path


def write_glb(path: Path, gltf: Gltf) -> Path:
    tree = {**gltf.tree, "buffers": [{"byteLength": len(gltf.data)}]}
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    data = bytes(gltf.data) + bytes(-len(gltf.data) % 4)
    chunks = (
        struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    )
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path
