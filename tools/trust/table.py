"""Table: what docs/reliability.md shows of the record, so that the page cannot say something else."""

from collections.abc import Mapping
from typing import Any

Section = Mapping[str, Any]


def rows(sections: Mapping[str, Section]) -> list[str]:
    """Return a row of Markdown for each experiment: what was tried, what came of it, findings, command.

    Args:
        sections: of the record, by name.
    """
    return [
        f"| {_tried(section)} | {told(section)} | {len(section['findings'])} | `{section['command']}` |"
        for name, told in TOLD.items()
        if (section := sections.get(name))
    ]


def reader_rows(section: Section) -> list[str]:
    """Return a row of Markdown for each reader: mutants, read, refused, slowest, largest memory."""
    return [
        f"| {name} | {found['mutants']} | {found['read']} | {found['refused']} | "
        f"{found['slowest_seconds']:.2f} s | {found['largest_mb']:.0f} MB |"
        for name, found in section["readers"].items()
    ]


def _tried(section: Section) -> str:
    for what in ("kills", "flips", "mutants", "runs"):
        if what in section:
            return f"{section[what]} {what}" + ("" if section["finished"] else ", so far")
    raise KeyError("kills, flips, mutants or runs")


def _fit(section: Section) -> str:
    return (
        f"{section['checkpoints_loaded']} checkpoints there after the kills load; "
        f"{section['runs_equal_to_the_unbroken_one']} of {section['runs']} resumed runs end as one not killed"
    )


def _render(section: Section) -> str:
    return (
        f"{section['data_sets_equal_to_the_unbroken_one']} of {section['data_sets']} data sets, rendered on, "
        f"are the unbroken one to the byte; {section['half_written_files_swept']} half-written files swept"
    )


def _flips(section: Section) -> str:
    return ", ".join(
        f"{section['mended'][kind]} of {n} in {kind} mended" for kind, n in section["in"].items()
    )


def _mutations(section: Section) -> str:
    readers = section["readers"].values()
    read, refused = (sum(found[outcome] for found in readers) for outcome in ("read", "refused"))
    slowest = max(found["slowest_seconds"] for found in readers)
    largest = max(found["largest_mb"] for found in readers)
    return f"{read} read, {refused} refused; {slowest:.2f} s and {largest:.0f} MB at most"


def _determinism(section: Section) -> str:
    digests = section["sha256_of_the_weights"]
    same = digests.count(digests[0])
    return f"{same} with the same seed end in the same bytes, {len(digests) - same} with another in others"


TOLD = {
    "kills-fit": _fit,
    "kills-render": _render,
    "flips": _flips,
    "mutations": _mutations,
    "determinism": _determinism,
}
