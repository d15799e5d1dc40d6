"""Checks the packages that normalgan depends on: their licences and known security advisories.

`make audit` runs it. It exits with 1 if a licence is not in the list below or an advisory is known. Without a
network it reports that advisories were not checked, and does not fail.
"""

import re
import subprocess
import sys
from email.message import Message
from importlib.metadata import Distribution, PackageNotFoundError, distribution

from packaging.requirements import Requirement

EXTRAS = ("", "train", "cluster", "export", "s3")
"""The extras that a user may install; developers' other packages are not shipped."""
PERMISSIVE = re.compile(
    r"\b(MIT|0?BSD|Apache|ISC|PSF|Python Software Foundation|MPL|HPND|CC0|Zlib|Unlicense|BSL-1|[23]-Clause)\b"
)
COPYLEFT = re.compile(r"\b[AL]?GPL|General Public", re.IGNORECASE)
TEXTS = ("Permission is hereby granted, free of charge", "Redistribution and use in source and binary forms")
"""Beginnings of the MIT and BSD licences, for packages that give a text instead of a name."""
CUDA = ("cuda-", "nvidia-")
"""Packages under NVIDIA's licence, which only PyTorch's build for NVIDIA's GPUs needs."""
TIMEOUT = 300


def dependencies(name: str, extras: tuple[str, ...] = EXTRAS) -> dict[str, Distribution]:
    """Return all direct and indirect dependencies of a package here, by name, except NVIDIA's."""
    found: dict[str, Distribution] = {}
    waiting = [(name, extras)]
    while waiting:
        package, wanted = waiting.pop()
        if package.startswith(CUDA):
            continue
        try:
            found_here = distribution(package)
        except PackageNotFoundError:
            continue  # needed only on another system
        if found_here.metadata["Name"] in found:
            continue
        found[found_here.metadata["Name"]] = found_here
        for text in found_here.requires or []:
            needed = Requirement(text)
            if needed.marker is None or any(needed.marker.evaluate({"extra": e}) for e in wanted):
                waiting.append((needed.name, ("", *needed.extras)))
    return found


def permissive(package: Distribution) -> bool:
    """Return whether a package's stated licence permits free use and redistribution."""
    metadata = package.metadata
    assert isinstance(metadata, Message)  # not so in the types of Python 3.11
    short = metadata.get("License") or ""
    said = [text for text in metadata.get_all("Classifier") or [] if text.startswith("License ::")]
    said += [metadata.get("License-Expression") or "", short if len(short) < 100 else ""]
    if any(COPYLEFT.search(text) for text in said):
        return False
    if any(PERMISSIVE.search(text) for text in said):
        return True
    files = [file for file in package.files or [] if re.search(r"licen[cs]e", file.name, re.IGNORECASE)]
    texts = [short, *(file.read_text(encoding="utf-8") for file in files if "dist-info" in str(file))]
    return any(beginning in text for text in texts for beginning in TEXTS)


def advisories() -> tuple[bool, str]:
    """Return whether the installed packages have no known advisory, and a line that reports it."""
    command = [sys.executable, "-m", "pip_audit", "--local", "--skip-editable", "--progress-spinner", "off"]
    try:
        done = subprocess.run(
            [*command, "--vulnerability-service", "osv"],
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return True, f"advisories: not checked; no answer within {TIMEOUT} seconds."
    if "No module named pip_audit" in done.stderr:
        return True, "advisories: not checked; pip-audit is not installed."
    if done.returncode == 0:
        # A package counts as sound if the service has no page for it or cannot be reached.
        skipped = len(re.findall(r"could not be audited", done.stdout + done.stderr))
        return True, f"advisories: none is known{f'; {skipped} packages not checked' if skipped else ''}."
    if re.search(r"vulnerabilit(y|ies) in", done.stderr + done.stdout):
        return False, f"advisories:\n{done.stdout.strip()}"
    reason = done.stderr.strip().splitlines()[-1:] or ["no reason given"]
    return True, f"advisories: not checked; their data cannot be reached ({reason[0][:100]})."


def main() -> int:
    """Print the findings, and return the exit code."""
    packages = dependencies("normalgan")
    unknown = sorted(name for name, package in packages.items() if not permissive(package))
    print(f"licences: {len(packages) - len(unknown)} of {len(packages)} packages are permissive.")
    for name in unknown:
        print(f"  {name}: its licence is not known to be")
    sound, line = advisories()
    print(line)
    return 0 if sound and not unknown else 1


if __name__ == "__main__":
    sys.exit(main())
