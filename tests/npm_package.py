"""Packages of npm that tests use, fetched once, by name, version and checksum; else the test is skipped."""

import base64
import hashlib
import io
import shutil
import subprocess
import tarfile
from pathlib import Path

import pytest

from needs import NPM

CACHE = Path(__file__).parents[1] / "build" / "npm"


def read_from_package(name: str, version: str, integrity: str, member: str) -> str:
    """Return a text file of a package.

    Args:
        name: of the package.
        version: of the package.
        integrity: its SHA-512 in base64, as a lock file of npm has it.
        member: path of the file in the package.
    """
    kept = CACHE / f"{name}-{version}.tgz"
    if not kept.is_file():
        npm = shutil.which("npm")
        if npm is None:
            pytest.skip(NPM.reason("it is not installed"))
        CACHE.mkdir(parents=True, exist_ok=True)
        command = [npm, "pack", f"{name}@{version}", "--fetch-retries=1", "--loglevel=silent"]
        subprocess.run(command, cwd=CACHE, capture_output=True, check=False)
        if not kept.is_file():
            pytest.skip(NPM.reason("it fetches nothing"))
    content = kept.read_bytes()
    assert base64.b64encode(hashlib.sha512(content).digest()).decode() == integrity, kept.name
    with tarfile.open(fileobj=io.BytesIO(content)) as packed:
        found = packed.extractfile(f"package/{member}")
        assert found is not None
        return found.read().decode()
