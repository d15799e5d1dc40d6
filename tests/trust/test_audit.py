"""The audit of what normalgan depends on; what is known of packages today is for `make audit` to ask."""

import importlib.util
import re
import tomllib
from pathlib import Path
from types import ModuleType

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
TOOL = ROOT / "tools" / "audit.py"
HOSTILE = (("lightning", "2.6.2"), ("lightning", "2.6.3"), ("h11", "0.15.0"), ("fsspec", "2026.5.0"))
"""Releases that run code of their own or of files, or mistake one request for two."""


@pytest.fixture(name="audit", scope="module")
def make_audit() -> ModuleType:
    spec = importlib.util.spec_from_file_location("audit", TOOL)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_all_that_is_depended_on_is_permissive(audit: ModuleType) -> None:
    packages = audit.dependencies("normalgan")
    assert {"torch", "lightning", "numpy", "sympy", "distributed"} <= packages.keys()  # extras and theirs too
    assert "pytest" not in packages
    assert [name for name, package in packages.items() if not audit.permissive(package)] == []


def test_releases_known_to_be_hostile_are_not_installed() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"].values()
    wanted = [Requirement(line) for lines in (project["dependencies"], *extras) for line in lines]
    allowed = {requirement.name: requirement.specifier for requirement in wanted}
    for name, version in HOSTILE:
        assert version not in allowed[name], name


def test_actions_are_pinned_by_hash() -> None:
    for path in (ROOT / ".github" / "workflows").glob("*.yml"):
        used = re.findall(r"uses: (.+)", path.read_text(encoding="utf-8"))
        assert used
        assert [each for each in used if not re.fullmatch(r"[\w/-]+@[0-9a-f]{40} # v[\d.]+", each)] == []
