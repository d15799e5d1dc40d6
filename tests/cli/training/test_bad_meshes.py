import json
from pathlib import Path

import pytest
from command import Bench, left_in

OFF = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
# Further files are in rendering/test_mesh_files.py, by the function that reads them.
BAD = {
    "nan.off": (OFF.replace("1 0 0", "nan 0 0").encode(), "not a finite number"),
    "array.npy": (b"\x93NUMPY", "is not a mesh file"),
}


def split(path: Path, **parts: list[str]) -> Path:
    path.write_text(json.dumps(parts))
    return path


@pytest.mark.filterwarnings("default")
def test_bad_meshes_are_named_and_left_out(bench: Bench, tmp_path: Path) -> None:
    paths = [tmp_path / name for name in BAD]
    for path in paths:
        path.write_bytes(BAD[path.name][0])
    good = (bench.meshes / name for name in ("ball.ply", "box.obj", "can.stl"))
    few = split(
        tmp_path / "few.json", train=["ball", *(path.stem for path in paths)], val=["box"], test=["can"]
    )
    outcome = bench.run(
        "render",
        tmp_path / "run",
        *("--data.meshes", f"[{','.join(map(str, [*good, *paths]))}]"),
        *("--data.split.file", few, "--data.cache", tmp_path / "cache"),
        *("--data.train_views", 1, "--data.val_views", 1, "--data.test_views", 1),
    )
    assert outcome.code == 0, outcome.err
    said = [line for line in outcome.err.splitlines() if line.startswith("normalgan: ")]
    assert len(said) == len(BAD)
    for name, (_, reason) in BAD.items():
        start = f"normalgan: warning: the mesh {Path(name).stem} is left out: "
        (line,) = (line for line in said if line.startswith(start))
        assert reason in line
    manifest = json.loads(next((tmp_path / "cache").glob("*/dataset.json")).read_text())
    assert manifest["samples"] == {
        "train": 1 + len(BAD),
        "val": 1,
        "test": 1,
    }  # places; of the bad ones blank


def test_a_split_of_bad_meshes_alone_fails(bench: Bench, tmp_path: Path) -> None:
    content, reason = BAD["nan.off"]
    bad = tmp_path / "nan.off"
    bad.write_bytes(content)
    few = split(tmp_path / "few.json", train=["ball"], val=[bad.stem], test=["can"])
    outcome = bench.run(
        "fit",
        tmp_path / "run",
        *("--data.meshes", f"[{bench.meshes}/ball.ply,{bench.meshes}/can.stl,{bad}]"),
        *("--data.split.file", few, "--data.cache", tmp_path / "cache"),
    )
    outcome.refused("the only mesh for val cannot be used", str(bad), reason)
    assert left_in(tmp_path) == ["few.json", "nan.off"]
