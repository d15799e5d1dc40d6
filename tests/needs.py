"""What tests need beyond Python, and what the end of a run says where it is missing."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Need:
    """Something that a machine may lack.

    Args:
        name: of it.
        tested: what is tested with it.
        get: how one gets it.
    """

    name: str
    tested: str
    get: str

    def reason(self, detail: str) -> str:
        """Return why a test is skipped: the start says which need it is, the detail what is wrong here."""
        return f"{self._start}{detail}"

    @property
    def _start(self) -> str:
        return f"{self.name} is missing: "

    def is_why(self, reason: str) -> bool:
        """Return whether a test was skipped for this."""
        return reason.removeprefix("Skipped: ").startswith(self._start)


CHROMIUM = Need(
    "Chromium",
    "pages in a browser",
    "apt-get install chromium, or name one: NORMALGAN_CHROMIUM=/path/of/chrome",
)
FIREFOX = Need(
    "Firefox",
    "unsaved work in Firefox",
    "apt-get install firefox-esr, or name one: NORMALGAN_FIREFOX=/path/of/firefox",
)
OPENGL = Need("OpenGL", "PyrenderRenderer", "apt-get install libegl1 libgl1")
NPM = Need("npm", "the JavaScript example", "apt-get install npm; one package is fetched from its registry")
SHARED_MESHES = Need("../shared/meshes", "real meshes and rigs", "they are not published")
SHARED_SKETCHES = Need("../shared/sketches", "drawings by people", "they are not published")
INKSCAPE = Need("Inkscape", "its add-on", "apt-get install inkscape python3-lxml python3-numpy xvfb")
GODOT3 = Need("Godot 3", "its add-on", "apt-get install godot3 godot3-server libgl1-mesa-dri xvfb")
GODOT4 = Need("Godot 4", "its add-on", "its editor as godot4, or the package godot of a Debian that has it")
BLENDER = Need("Blender", "its add-on", "apt-get install blender")
GIMP2 = Need("GIMP 2.10", "its add-on", "apt-get install gimp, of Debian 12 or Ubuntu 24.04")
GIMP3 = Need("GIMP 3", "its add-on", "apt-get install gimp python3-gi gir1.2-gimp-3.0, of Debian 13 or newer")
KRITA = Need("Krita", "its add-on", "apt-get install krita python3-pyqt5 xvfb")
LUA = Need("Lua", "the script for Aseprite", "apt-get install lua5.4")
NEEDS = (
    *(CHROMIUM, FIREFOX, OPENGL, NPM, SHARED_MESHES, SHARED_SKETCHES),
    *(INKSCAPE, GODOT3, GODOT4, BLENDER, GIMP2, GIMP3, KRITA, LUA),
)


def not_tested(reasons: Iterable[str]) -> list[str]:
    """Return a line for each thing that is missing.

    Args:
        reasons: why tests were skipped, one for each.

    Returns:
        Such as "not tested, as npm is missing: the JavaScript example (2 tests); apt-get install npm".
    """
    skipped = Counter(need for reason in reasons for need in NEEDS if need.is_why(reason))
    return [
        f"not tested, as {need.name} is missing: {need.tested} "
        f"({skipped[need]} {'test' if skipped[need] == 1 else 'tests'}); {need.get}"
        for need in NEEDS
        if skipped[need]
    ]
