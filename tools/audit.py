"""Looks at what normalgan depends on: the licence of each package, and what is known against it.

`make audit` runs it. It ends with 1 if a licence is none of those below or an advisory is known. Advisories
that cannot be reached are said to be unchecked, and are no failure: a build without a network is not red.
"""

import re
import subprocess
import sys
from email.message import Message
from importlib.metadata import Distribution, PackageNotFoundError, distribution

from packaging.requirements import Requirement

EXTRAS = ("", "train", "cluster", "export", "s3")
"""What a user may install; what developers use besides is not shipped."""
PERMISSIVE = re.compile(
    r"\b(MIT|0?BSD|Apache|ISC|PSF|Python Software Foundation|MPL|HPND|CC0|Zlib|Unlicense|BSL-1|[23]-Clause)\b"
)
COPYLEFT = re.compile(r"\b[AL]?GPL|General Public", re.IGNORECASE)
TEXTS = ("Permission is hereby granted, free of charge", "Redistribution and use in source and binary forms")
"""How the licences of MIT and BSD begin, for packages that give a text and no name."""
CUDA = ("cuda-", "nvidia-")
"""Packages of PyTorch's build for NVIDIA's GPUs, under NVIDIA's licence; the build for the CPU has none."""
SECONDS = 300


def dependencies(name: str, extras: tuple[str, ...] = EXTRAS) -> dict[str, Distribution]:
    """Return the packages that one needs here, by name, and those that they need, without NVIDIA's."""
    found: dict[str, Distribution] = {}
    waiting = [(name, extras)]
    while waiting:
        package, wanted = waiting.pop()
        if package.startswith(CUDA):
            continue
        try:
            found_here = distribution(package)
        except PackageNotFoundError:
            continue  # of another system
        if found_here.metadata["Name"] in found:
            continue
        found[found_here.metadata["Name"]] = found_here
        for text in found_here.requires or []:
            needed = Requirement(text)
            if needed.marker is None or any(needed.marker.evaluate({"extra": e}) for e in wanted):
                waiting.append((needed.name, ("", *needed.extras)))
    return found


def permissive(package: Distribution) -> bool:
    """Return whether a package may be used and passed on freely, by what it says of its licence."""
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
    """Return whether nothing is known against the installed packages, and a line on it."""
    command = [sys.executable, "-m", "pip_audit", "--local", "--skip-editable", "--progress-spinner", "off"]
    try:
        done = subprocess.run(
            [*command, "--vulnerability-service", "osv"],
            capture_output=True,
            text=True,
            timeout=SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return True, f"advisories: not checked; no answer within {SECONDS} seconds."
    if "No module named pip_audit" in done.stderr:
        return True, "advisories: not checked; pip-audit is not installed."
    if done.returncode == 0:
        # A package that the service has no page of, or none that can be reached, counts as sound there.
        skipped = len(re.findall(r"could not be audited", done.stdout + done.stderr))
        return True, f"advisories: none is known{f'; {skipped} packages not checked' if skipped else ''}."
    if re.search(r"vulnerabilit(y|ies) in", done.stderr + done.stdout):
        return False, f"advisories:\n{done.stdout.strip()}"
    reason = done.stderr.strip().splitlines()[-1:] or ["no reason given"]
    return True, f"advisories: not checked; their data cannot be reached ({reason[0][:100]})."


def main() -> int:
    """Print what was found; return the exit code."""
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
