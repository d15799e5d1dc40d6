"""The installer of the add-ons: where each goes, and the command that is noted beside it."""

import os
import runpy
from pathlib import Path, PurePath

import pytest
from add_ons import DOG, ROOT, install, own_command
from PIL import Image

from normal_pngs import read_png


@pytest.mark.parametrize(
    ("system", "environment", "expected"),
    [
        (
            "linux",
            {},
            {
                "aseprite": ".config/aseprite",
                "blender": ".config/blender",
                "gimp": ".config/GIMP",
                "inkscape": ".config/inkscape",
                "krita": ".local/share/krita",
            },
        ),
        (
            "win32",
            {"APPDATA": "home/Roaming"},
            {
                "aseprite": "Roaming/Aseprite",
                "blender": "Roaming/Blender Foundation/Blender",
                "gimp": "Roaming/GIMP",
                "inkscape": "Roaming/inkscape",
                "krita": "Roaming/krita",
            },
        ),
        (
            "darwin",
            {},
            {
                "aseprite": "Library/Application Support/Aseprite",
                "blender": "Library/Application Support/Blender",
                "gimp": "Library/Application Support/GIMP",
                "inkscape": "Library/Application Support/org.inkscape.Inkscape/config/inkscape",
                "krita": "Library/Application Support/krita",
            },
        ),
    ],
)
def test_programs_keep_what_users_add_elsewhere_on_each_system(
    system: str, environment: dict[str, str], expected: dict[str, str]
) -> None:
    installer = runpy.run_path(str(ROOT / "integrations" / "install.py"))
    found = installer["program_folders"](system, PurePath("home"), environment)
    assert {name: PurePath(path).relative_to("home").as_posix() for name, path in found.items()} == expected


def test_a_command_of_the_search_path_is_noted_by_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    command = own_command(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    install("gimp3", tmp_path, "--to", str(tmp_path / "plug-ins"), "--normalgan", "normalgan")
    note = tmp_path / "plug-ins" / "normalgan_gimp3" / "normalgan_path.txt"
    assert Path(note.read_text(encoding="utf-8").strip()).samefile(command)


@pytest.mark.slow
def test_what_is_installed_calls_the_command_that_is_noted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On whatever system: no add-on's program is needed for it."""
    monkeypatch.delenv("NORMALGAN", raising=False)
    install("gimp3", tmp_path, "--to", str(tmp_path / "plug-ins"), "--normalgan", str(own_command(tmp_path)))
    called = runpy.run_path(str(tmp_path / "plug-ins" / "normalgan_gimp3" / "normalgan_command.py"))
    drawing = tmp_path / "a dog.png"
    drawing.write_bytes(DOG.read_bytes())
    assert called["predict"](drawing, tmp_path / "dog_normal.png") == ""
    with Image.open(DOG) as picture:
        assert read_png(tmp_path / "dog_normal.png")[0].shape == (picture.height, picture.width, 3)
    with pytest.raises(called["CommandError"], match=r"(?m)^normalgan: no sketch found at "):
        called["predict"](tmp_path / "none.png", tmp_path / "none_normal.png")


def test_every_add_on_can_be_installed(tmp_path: Path) -> None:
    names = {path.name for path in (ROOT / "integrations").iterdir() if path.is_dir()} - {"__pycache__"}
    for name in names:
        assert "Installed in" in install(name, tmp_path, "--to", str(tmp_path / name))
        assert list((tmp_path / name).rglob("*"))
