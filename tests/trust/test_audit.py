"""The audit of what normalgan depends on; what is known of packages today is for `make audit` to ask."""

import importlib.util
import re
import subprocess
import tomllib
from email.message import Message
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

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


@pytest.mark.parametrize(
    ("field", "text", "good"),
    [
        ("License-Expression", "MIT", True),
        ("License-Expression", "Apache-2.0 AND MIT", True),
        ("License-Expression", "GPL-3.0-only", False),
        ("License-Expression", "MIT AND LGPL-2.1-or-later", False),
        ("Classifier", "License :: OSI Approved :: GNU General Public License v3 (GPLv3)", False),
        ("Classifier", "Topic :: MIT", False),
        ("License", "Proprietary", False),
        (
            "License",
            "Permission is hereby granted, free of charge, to any person obtaining a copy" + " " * 99,
            True,
        ),
        ("Name", "silent", False),
    ],
)
def test_a_licence_is_read_where_packages_say_it(
    audit: ModuleType, field: str, text: str, good: bool
) -> None:
    metadata = Message()
    metadata[field] = text
    assert audit.permissive(SimpleNamespace(metadata=metadata, files=[])) is good


@pytest.mark.parametrize(
    ("code", "said", "error", "sound", "words"),
    [
        (0, "", "No known vulnerabilities found", True, "advisories: none is known."),
        (
            0,
            "numpy Dependency not found on PyPI and could not be audited: numpy (2.4.6)",
            "No known vulnerabilities found",
            True,
            "none is known; 1 packages not checked",
        ),
        (1, "idna 3.6 PYSEC-2024-60", "Found 1 known vulnerability in 1 package", False, "PYSEC-2024-60"),
        (1, "", "urllib3: Name or service not known", True, "not checked; their data cannot be reached"),
        (1, "", "python: No module named pip_audit", True, "not checked; pip-audit is not installed"),
    ],
)
def test_advisories_that_cannot_be_reached_are_said_to_be_unchecked(
    audit: ModuleType,
    monkeypatch: pytest.MonkeyPatch,
    code: int,
    said: str,
    error: str,
    sound: bool,
    words: str,
) -> None:
    def run(*_: Any, **__: Any) -> "subprocess.CompletedProcess[str]":
        return subprocess.CompletedProcess([], code, said, error)

    monkeypatch.setattr(subprocess, "run", run)
    assert audit.advisories()[0] is sound
    assert words in audit.advisories()[1]
