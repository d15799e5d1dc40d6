"""The documentation's site: all pages are in its navigation, nothing is fetched from elsewhere, it builds."""

import os
import re
import runpy
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
CONFIG = ROOT / "mkdocs.yml"


class Loader(yaml.SafeLoader):
    """Reads mkdocs.yml, whose tags name Python functions, without calling any."""


Loader.add_multi_constructor("", lambda _loader, _tag, _node: None)


def navigation() -> list[str]:
    """Return the pages of the navigation."""

    def pages(entry: Any) -> Iterator[str]:
        if isinstance(entry, str):
            yield entry
        else:
            for part in entry.values() if isinstance(entry, dict) else entry:
                yield from pages(part)

    with CONFIG.open(encoding="utf-8") as file:
        return list(pages(yaml.load(file, Loader)["nav"]))


def test_every_page_is_in_the_navigation_once() -> None:
    named = navigation()
    assert len(named) == len(set(named))
    written = {page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md")}
    made = {"contributing.md", "changelog.md"} | {
        f"reference/{name}.md" for name in ("commands", "settings", "parts", "configurations")
    }
    notebooks = {f"notebooks/{path.stem}.md" for path in (ROOT / "notebooks").glob("*.ipynb")}
    assert written | made | notebooks == set(named)


def test_links_of_the_reference_lead_somewhere() -> None:
    made = {DOCS / page for page in navigation()}
    for page in (DOCS / "reference").glob("*.md"):
        for target in re.findall(r"\]\(([^)\s#]+)", page.read_text(encoding="utf-8")):
            there = (page.parent / target).resolve()
            assert there.exists() or there in made, f"{page.name} links to {target}"


def test_configurations_page_shows_every_file_and_links_find_them() -> None:
    outside = runpy.run_path(str(ROOT / "tools" / "site" / "outside.py"))
    page = outside["configurations"]()
    for path in (ROOT / "configs").rglob("*.yaml"):
        name = path.relative_to(ROOT).as_posix()
        assert f"## {name} {{ #{outside['slug'](name)} }}" in page
        assert path.read_text(encoding="utf-8").rstrip() in page


class Addresses(HTMLParser):
    """Collects what a page would fetch by itself."""

    def __init__(self) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.equations = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if tag in {"script", "img", "iframe", "source", "video"} and given.get("src"):
            self.fetched.append(given["src"] or "")
        if tag == "link" and given.get("rel") in {"stylesheet", "icon", "preconnect", "preload"}:
            self.fetched.append(given["href"] or "")
        self.equations += tag == "math"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built as `make docs` builds it: a warning fails. NORMALGAN_SITE names one that was."""
    if built := os.environ.get("NORMALGAN_SITE"):
        return Path(built)
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "-d", str(folder)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return folder


@pytest.mark.slow  # imports lightning for the table of settings
def test_site_builds_and_fetches_nothing(site: Path) -> None:
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > len(navigation())
    equations = 0
    for page in pages:
        read = Addresses()
        read.feed(page.read_text(encoding="utf-8"))
        assert not [address for address in read.fetched if re.match(r"(https?:)?//", address)], page
        equations += read.equations
        base = site if page.name == "404.html" else page.parent
        for address in read.fetched:
            there = site / address.lstrip("/") if address.startswith("/") else base / address
            assert there.is_file(), f"{page} shows {address}"
    assert equations > 40
    for style in site.rglob("*.css"):
        assert "@import" not in style.read_text(encoding="utf-8")
    everything = "".join(page.read_text(encoding="utf-8") for page in pages)
    assert str(ROOT) not in everything


@pytest.mark.slow
def test_pages_made_from_the_code_say_what_help_says(site: Path) -> None:
    settings = (site / "reference" / "settings.html").read_text(encoding="utf-8")
    for name in (
        "seed_everything",
        "train_views",
        "reconstruction",
        "gradient_clip",
        "max_epochs",
        "crease_angle",
    ):
        assert f"{name}</code>" in settings
    parts = (site / "reference" / "parts.html").read_text(encoding="utf-8")
    for name in ("CurvatureHints", "ResidualUNetGenerator", "WassersteinGradientPenalty", "Brush"):
        assert name in parts
    commands = (site / "reference" / "commands.html").read_text(encoding="utf-8")
    for name in ("--crease_angle", "--dry-run", "--half", "--projects", "--kind"):
        assert f"{name}</code>" in commands
