"""Clips: the moments of an animation before one camera."""

from pathlib import Path

import numpy as np
import pytest
from rig_files import bar, write_glb

from normal_pngs import read_png
from normalgan.__main__ import main
from normalgan.errors import InputError
from normalgan.rendering.mesh_files import MeshFile
from normalgan.rendering.rigs import ClipMeshes


def test_parts_that_do_not_move_stay_in_place(tmp_path: Path) -> None:
    """The lower half of a bar stands while its upper half is bent by 90°."""
    meshes = ClipMeshes(MeshFile(str(write_glb(tmp_path / "bar.glb", bar()[0]))), "0")
    first, last = meshes.span
    straight, bent = meshes.mesh(first).vertices, meshes.mesh(last).vertices
    low = straight[:, 1].min()
    foot = straight[straight[:, 1] < low + 0.05]
    assert len(foot)
    assert all(np.abs(bent - each).max(1).min() < 1e-5 for each in foot)
    assert np.ptp(bent[:, 1]) < 0.8 * np.ptp(straight[:, 1])
    # The view of a clip holds all of its moments.
    for vertices in (straight, bent):
        assert (vertices.min(0) >= meshes.hull.min(0) - 1e-6).all()
        assert (vertices.max(0) <= meshes.hull.max(0) + 1e-6).all()


def test_a_missing_clip_is_an_error_that_lists_the_clips(tmp_path: Path) -> None:
    file = MeshFile(str(write_glb(tmp_path / "bar.glb", bar()[0])))
    with pytest.raises(InputError, match=r"has no clip 'Walk'.* Its clips: "):
        ClipMeshes(file, "Walk")
    with pytest.raises(InputError, match="has no animation"):
        ClipMeshes(MeshFile(str(write_glb(tmp_path / "still.glb", bar(clips=False)[0]))), "0")


def test_sketch_draws_a_moment_of_a_clip(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig = str(write_glb(tmp_path / "bar.glb", bar()[0]))
    masks = []
    for time in ("0", "1"):
        out = str(tmp_path / f"{time}.png")
        asked = ["--clip", "0", "--time", time, "--size", "96", "--azimuth", "0"]
        assert main(["sketch", rig, "-o", str(tmp_path / "a.png"), "--normal", out, *asked]) == 0
        masks.append(np.abs(read_png(out)[0][..., :2]).max(-1) > 0.02)
    both, either = (masks[0] & masks[1]).sum(), (masks[0] | masks[1]).sum()
    assert 0.05 < both / either < 0.8
    for asked, sentence in (
        (["--clip", "0", "--time", "9"], "time is 9.0; the clip 0 runs from 0 to 1 seconds."),
        (["--time", "1"], "a time needs a clip; name one with --clip."),
    ):
        assert main(["sketch", rig, "-o", str(tmp_path / "b.png"), *asked]) == 2
        assert sentence in capsys.readouterr().err
    assert main(["sketch", "horse", "--clip", "0", "-o", str(tmp_path / "b.png")]) == 2
    assert "horse has no clips; give a rigged glTF file." in capsys.readouterr().err
