"""A pointer of Git LFS in place of a file is told as such, whatever reads it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from normalgan.animals.species import read_species
from normalgan.cli.parsing.config_files import check_config
from normalgan.errors import InputError
from normalgan.files.torch_files import load_torch_file
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.reading.drawings import read_drawing, read_normals
from normalgan.inference.reading.hint_files import load_hints
from normalgan.inference.reading.picture import read_picture
from normalgan.rendering.mesh_files import MeshFile, read_orientations
from normalgan.weights.file import read_weights

POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:" + b"4d7a21" * 10 + b"abcd\nsize 12345\n"
READERS: dict[str, Callable[[Path], object]] = {
    "fox.png": read_drawing,
    "fox.kra": read_picture,
    "upload.svg": lambda path: read_picture(Path("upload.svg"), path.read_bytes()),
    "fox_normal.exr": read_normals,
    "fox_normal.png": read_normals,
    "fox_hints.json": lambda path: load_hints(path, (8, 8)),
    "fox_hints.png": lambda path: load_hints(path, (8, 8)),
    **{
        f"mesh{suffix}": lambda path: MeshFile(str(path)).load()
        for suffix in (".obj", ".ply", ".stl", ".glb")
    },
    "rig.gltf": lambda path: MeshFile(str(path)).fingerprint(),
    "turns.json": lambda path: read_orientations(str(path)),
    "ours.onnx": OnnxBackend,
    "ours.safetensors": read_weights,
    "last.ckpt": load_torch_file,
    "paper.yaml": check_config,
    "cat.toml": read_species,
}


@pytest.mark.parametrize("name", READERS)
def test_a_pointer_is_named_with_what_fetches_the_file(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(POINTER)
    with pytest.raises(InputError) as refused:
        READERS[name](tmp_path / name)
    said = str(refused.value)
    assert (
        f"{name} is a Git LFS pointer and not the file itself; run `git lfs pull` in its repository." in said
    )
