from pathlib import Path

import pytest

from normalgan.files.globs import matches


def test_a_folder_that_exists_is_meant_literally(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("[WIP] tree/a.png", "[WIP] tree/deep/b.png", "W tree/c.png", "1/d.png", "e.png"):
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).touch()
    for pattern, found in {
        "[WIP] tree/*.png": ["[WIP] tree/a.png"],
        "[WIP] tree/**/*.png": ["[WIP] tree/a.png", "[WIP] tree/deep/b.png"],
        "[WI] tree/*.png": ["W tree/c.png"],
        "[0-9]/*.png": ["1/d.png"],
        "*.png": ["e.png"],
        "gone/*.png": [],
    }.items():
        assert matches(pattern) == [Path(each) for each in found]
        assert matches(str(tmp_path / pattern)) == [tmp_path / each for each in found]
