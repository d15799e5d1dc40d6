"""Page files: preload modules and put versions into addresses, so that the page loads fast."""

import hashlib
import posixpath
import re
from collections.abc import Iterable
from pathlib import Path

PAGE = Path(__file__).parent / "page"
"""The folder of the page's files."""
_IMPORT = re.compile(r'^(?:import|export)\b(?:[^;"]*?\bfrom\b)?\s*"(\.{1,2}/[\w./]+)"', re.MULTILINE)
_SCRIPT = re.compile(r'^<script type="module" src="([^"]*/)([\w.]+)"></script>', re.MULTILINE)


def modules_of(folder: Path, first: str) -> list[str]:
    """Return a module and all modules that it imports, in the order in which a browser discovers them.

    Args:
        folder: folder of all modules.
        first: path of the module that the page loads, relative to the folder.
    """
    found = [first]
    for name in found:
        text = (folder / name).read_text(encoding="utf-8")
        imported = (posixpath.join(posixpath.dirname(name), path) for path in _IMPORT.findall(text))
        found += [each for each in dict.fromkeys(map(posixpath.normpath, imported)) if each not in found]
    return found


def markup(text: str, folder: Path) -> str:
    """Return a page that preloads all modules of its scripts.

    Without preloading, a browser requests a module only after the module that imports it has arrived.

    Args:
        text: HTML of the page.
        folder: folder of the modules.
    """
    scripts = list(_SCRIPT.finditer(text))
    needed = dict.fromkeys(
        address + name
        for address, first in (script.groups() for script in scripts)
        for name in modules_of(folder, first)
    )
    links = "".join(f'<link rel="modulepreload" href="{address}">\n' for address in needed)
    at = scripts[0].start()
    return text[:at] + links + text[at:]


def version_of(files: Iterable[Path]) -> str:
    """Return a hash of the files."""
    whole = hashlib.sha256()
    for path in sorted(files):
        whole.update(f"{path.name}\0{path.stat().st_size}\0".encode())
        whole.update(path.read_bytes())
    return whole.hexdigest()[:16]
