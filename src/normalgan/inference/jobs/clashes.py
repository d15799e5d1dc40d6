"""Clashes: find drawings whose maps would be written to the same file."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from normalgan.errors import InputError
from normalgan.inference.jobs.plan import DrawingFiles, Job
from normalgan.inference.reading.drawings import LAYERED


def without_twins(
    files: Sequence[DrawingFiles], layers: bool = False
) -> tuple[list[DrawingFiles], list[str]]:
    """Drop either the layered file or its export where both exist; return the rest and messages about it.

    An artist saves ``fox.kra`` and exports ``fox.png`` next to it. The engine displays the export, so the map
    is predicted from the export, unless ``layers`` are to be predicted, which only the layered file has.

    Example:
        >>> pair = [DrawingFiles(Path("art", name)) for name in ("fox.kra", "fox.png")]
        >>> [str(each.drawing.name) for each in without_twins(pair)[0]]
        ['fox.png']
        >>> [str(each.drawing.name) for each in without_twins(pair, layers=True)[0]]
        ['fox.kra']
    """
    kinds: dict[Path, dict[bool, Path]] = {}
    for each in files:
        kinds.setdefault(each.drawing.with_suffix(""), {}).setdefault(_is_layered(each), each.drawing)
    kept, said = [], []
    for each in files:
        pair = kinds[each.drawing.with_suffix("")]
        if len(pair) == 1 or _is_layered(each) == layers:
            kept.append(each)
            continue
        why = "has its layers" if layers else "is its export"
        said.append(f"{each.drawing} is skipped, because {pair[layers].name} next to it {why}.")
    return kept, said


def without_clashes(
    jobs: Sequence[Job], written: Callable[[Job], Iterable[Path]]
) -> tuple[list[Job], list[InputError]]:
    """Return the jobs whose output files are unique, and an error for each of the others.

    If two drawings would be written to the same file, neither is predicted, because it is unknown which one
    was meant.

    Args:
        jobs: the jobs to check.
        written: returns the output files of a job; only called for jobs whose maps may clash.
    """
    named = Counter(job.target for job in jobs)
    files = {i: set(written(job)) for i, job in enumerate(jobs) if named[job.target] > 1}
    counted = Counter(path for each in files.values() for path in each)
    kept, wrong = [], []
    for i, job in enumerate(jobs):
        twice = sorted(path for path in files.get(i, ()) if counted[path] > 1)
        if twice:
            wrong.append(
                InputError(
                    f"{job.files.drawing}: {twice[0]} would be written twice; "
                    "rename a sketch, or give another --suffix."
                )
            )
        else:
            kept.append(job)
    return kept, wrong


def _is_layered(files: DrawingFiles) -> bool:
    return files.content is None and files.drawing.suffix.lower() in LAYERED
