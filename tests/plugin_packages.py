"""Packages that offer plug-ins, as pip would leave them: modules, and a dist-info with entry points."""

import gc
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest


def install(
    site: Path, package: str, modules: Mapping[str, str], entries: Mapping[str, Mapping[str, str]]
) -> None:
    """Write a package of version 1.5 into a folder.

    Args:
        site: the folder, which is to be on the path.
        package: its name.
        modules: the source of each module.
        entries: entry points, ``module:Class`` by name, by group.
    """
    for name, source in modules.items():
        (site / f"{name}.py").write_text(source, encoding="utf-8")
    info = site / f"{package}-1.5.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.5\n")
    lines = []
    for group, points in entries.items():
        lines += [f"[{group}]", *(f"{name} = {value}" for name, value in points.items())]
    (info / "entry_points.txt").write_text("\n".join(lines))


@pytest.fixture(name="site")
def make_site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder on the path; what is imported from it, and what registries learn, is forgotten afterwards."""
    from normalgan.cli.discovery import (
        REGISTRIES,  # here: every test run loads this module, and few need torch
    )

    site = tmp_path / "site"
    site.mkdir()
    monkeypatch.syspath_prepend(site)
    for registry in REGISTRIES.values():
        monkeypatch.setattr(registry, "_classes", dict(registry._classes))
        monkeypatch.setattr(registry, "_packages", dict(registry._packages))
        monkeypatch.setattr(registry, "left_out", [])
    before = set(sys.modules)
    yield site
    for name in set(sys.modules) - before:
        if str(getattr(sys.modules[name], "__file__", "")).startswith(str(site)):
            del sys.modules[name]
    gc.collect()  # else a class of it stays among the subclasses, and makes a short name ambiguous
