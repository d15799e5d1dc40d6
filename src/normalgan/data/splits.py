"""Splits of meshes, not of views, into training, validation and testing."""

import warnings
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from normalgan.errors import InputError
from normalgan.files.json_files import read_json
from normalgan.files.shipped_configs import find_beside

SPLITS = ("train", "val", "test")
"""The names of the splits, in the order of the fractions."""
_FEW = 5
"""Maximum number of names in a message."""

_Names = dict[str, list[str]]


def split_by_fractions(
    names: Sequence[str], fractions: tuple[float, float, float], seed: int = 0, noun: str = "mesh"
) -> _Names:
    """Split meshes randomly in given proportions; names keep their order within a split.

    Counts are rounded by the largest remainder method, but each fraction above 0 gets at least one mesh.
    The split depends on the set of names and the seed, not on the order of names.

    Args:
        names: names of the meshes.
        fractions: fractions of training, validation and testing, which sum to 1.
        seed: random seed.
        noun: word for a mesh in messages.

    Returns:
        The names in ``train``, ``val`` and ``test``; an empty list where the fraction is 0.

    Raises:
        InputError: if two meshes have the same name, the fractions are invalid, or there are fewer meshes
            than fractions above 0.

    Example:
        >>> {k: len(v) for k, v in split_by_fractions("abcdefghij", (0.8, 0.1, 0.1)).items()}
        {'train': 8, 'val': 1, 'test': 1}
    """
    _refuse_twins(names, noun)
    if len(fractions) != len(SPLITS) or min(fractions) < 0 or not abs(sum(fractions) - 1) <= 1e-6:
        raise InputError(
            f"the fractions are {tuple(fractions)}; they must be three shares (train, val, test), none "
            "below 0, that sum to 1."
        )
    wanted = sum(share > 0 for share in fractions)
    if len(names) < wanted:
        raise InputError(
            f"{len(names)} {noun if len(names) == 1 else plural(noun)} cannot be split in {wanted} parts; "
            f"add {plural(noun)} or set a fraction to 0."
        )
    counts = _apportion(len(names), fractions)
    dealt = np.random.default_rng(seed).permutation(sorted(names)).tolist()
    split: _Names = {}
    for part, count in zip(SPLITS, counts, strict=True):
        chosen, dealt = set(dealt[:count]), dealt[count:]
        split[part] = [name for name in names if name in chosen]
    return split


def split_by_file(path: Path, names: Sequence[str], noun: str = "mesh") -> _Names:
    """Return the split in a JSON file: ``{"train": ["381", …], "val": […], "test": […]}``.

    Meshes that are not in the file are left out with a warning.

    Args:
        path: path of the file, or of a shipped one, such as ``configs/fourleg/split.json``.
        names: names of the available meshes.
        noun: word for a mesh in messages.

    Raises:
        InputError: if the file is invalid, names a missing mesh, or names a mesh twice.
    """
    _refuse_twins(names, noun)
    split = _read(find_beside(str(path)))
    named = [name for part in split.values() for name in part]
    known, listed = set(names), set(named)
    unknown = [name for name in named if name not in known]
    if unknown:
        raise InputError(
            f"{path} names {_few(unknown)}, but there is no such {noun} among the {len(names)} given."
        )
    if twice := repeated(named):
        raise InputError(f"{path} names {_few(twice)} more than once; a {noun} belongs to one split only.")
    left_out = [name for name in names if name not in listed]
    if left_out:
        warnings.warn(f"left out, because {path} does not name them: {_few(left_out)}.", stacklevel=2)
    return split


def _read(path: Path) -> _Names:
    right = 'it must be like {"train": ["a", "b"], "val": ["c"], "test": ["d"]}.'
    content = read_json(path, "the split file", right)
    if not isinstance(content, dict) or not content or set(content) - set(SPLITS):
        raise InputError(f"the split file {path} does not map train, val and test to names; {right}")
    for part, listed in content.items():
        if not isinstance(listed, list) or not all(isinstance(name, str) for name in listed):
            raise InputError(f"{part!r} in the split file {path} is not a list of names; {right}")
    return {part: content.get(part, []) for part in SPLITS}


def _apportion(total: int, fractions: Sequence[float]) -> list[int]:
    """Return integer counts that sum to ``total``, at least 1 where the fraction is above 0."""
    counts = [int(total * share + 1e-9) for share in fractions]
    remainders = [total * share - count for share, count in zip(fractions, counts, strict=True)]
    for i in sorted(range(len(counts)), key=lambda i: -remainders[i])[: total - sum(counts)]:
        counts[i] += 1
    for i, share in enumerate(fractions):
        if share > 0 and counts[i] == 0:
            counts[counts.index(max(counts))] -= 1
            counts[i] = 1
    return counts


def plural(noun: str) -> str:
    """Return the plural of a noun.

    >>> plural("mesh"), plural("pair")
    ('meshes', 'pairs')
    """
    return f"{noun}{'es' if noun.endswith(('s', 'sh', 'ch', 'x')) else 's'}"


def repeated(names: Sequence[str]) -> list[str]:
    """Return the names that occur more than once, in the order of their first occurrence."""
    return [name for name, times in Counter(names).items() if times > 1]


def none_usable(count: int, noun: str, split: str, reason: str) -> InputError:
    """Return the error for a split where none of ``count`` meshes or pairs is usable.

    >>> str(none_usable(1, "mesh", "val", "a.ply is empty."))
    'the only mesh for val cannot be used: a.ply is empty.'
    """
    if count == 1:
        return InputError(f"the only {noun} for {split} cannot be used: {reason}")
    return InputError(f"none of the {count} {plural(noun)} for {split} can be used; the first: {reason}")


def _refuse_twins(names: Sequence[str], noun: str) -> None:
    if twins := repeated(names):
        raise InputError(f"two {plural(noun)} are named {_few(twins)}; each {noun} needs a unique name.")


def _few(names: Sequence[str]) -> str:
    more = f" and {len(names) - _FEW} more" if len(names) > _FEW else ""
    return ", ".join(names[:_FEW]) + more
