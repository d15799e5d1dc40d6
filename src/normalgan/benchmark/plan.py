"""Plan: read and check the YAML file with the rows and settings of a benchmark."""

import re
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, TypeVar

from normalgan.cli.parsing.config_files import check_config
from normalgan.errors import InputError
from normalgan.files.limits import load_yaml
from normalgan.files.shipped_configs import find_config
from normalgan.ranges import Count, NonNegative, PositiveInt, check_ranges
from normalgan.records import Record, read_record

Settings = dict[str, Any]
_DRAWN = ("hand", "lines", "medium")
_MESHES = ("meshes", "reading", "split", "test_views")
_TEST_DATA = (*_DRAWN, *_MESHES)
"""Data settings that may differ for the test split; its size may not, because it must match the networks."""
Placement = Literal["uniform", "curvature", "farthest", "worst"]
"""Ways to place hints; see `normalgan.benchmark.hints`, which is not imported here because it needs torch."""
Part = TypeVar("Part", "Plan", "Row")


@dataclass(frozen=True)
class Row(Record):
    """A row of the table: a trained method, or a classical method without training.

    The settings of a trained method are composed as for `normalgan fit`. In increasing order of precedence,
    they are the row's configs, its changes, the plan's data, the scale's overlays and the row's settings.

    Args:
        name: name of the row's folder.
        label: label in tables and pictures.
        group: heading in tables.
        classical: name of a method without training; None for a trained method.
        configs: configuration files, relative to the plan, or else to the working directory.
        changes: dotted settings that the scale's overlays override.
        settings: dotted settings that override the scale's overlays.
        takes: dotted names of the settings that the row takes from the overlays; None takes all.
    """

    name: str
    label: str
    group: str = ""
    classical: Literal["constant", "mean", "inflation"] | None = None
    configs: list[str] = field(default_factory=list)
    changes: dict[str, Any] = field(default_factory=dict)
    settings: dict[str, Any] = field(default_factory=dict)
    takes: list[str] | None = None

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[\w-]+", self.name):
            raise InputError(f"a row is named {self.name!r}; use letters, digits, - and _.")
        if (self.classical is None) == (not self.configs):
            raise InputError(f"the row {self.name} must have either configs or classical.")
        if self.classical and (self.changes or self.settings or self.takes is not None):
            raise InputError(f"the row {self.name} is classical and cannot have settings, changes or takes.")


@dataclass(frozen=True)
class Plan(Record):
    """A benchmark.

    Args:
        name: name of the benchmark in reports.
        images: number of training images of each generator, including repetitions.
        rows: the methods to compare.
        data: data settings that all rows share.
        test_data: data settings that differ for the test split, such as its drawing style or its meshes.
        seeds: seeds of initialisation, training hints and dropout; each row has one run per seed.
        hints: number of hints in table 1.
        hint_counts: numbers of hints in the curve; 0 and ``hints`` are always measured.
        hint_seed: seed of the test hints.
        checkpoint: checkpoint that is measured: the ``best`` on the validation split, or the ``last``.
        gallery: number of test samples in the gallery.
        reference: name of the row that is shown in every panel of the curves.
        placements: ways to place hints with which all methods are tested, at equal counts.
        placement_counts: numbers of hints for each placement.
        noise_degrees: angles by which the hints of table 1 are rotated in tests of inaccurate hints.
        noise_pixels: distances by which the hints of table 1 are moved in tests of inaccurate hints.
        pins: number of pins that a simulated user places one by one; 0 disables the test.
        metrics: additional metrics, each a name or a mapping with ``class_path`` and ``init_args``.
    """

    name: str
    images: PositiveInt
    rows: list[Row]
    data: dict[str, Any] = field(default_factory=dict)
    test_data: dict[str, Any] = field(default_factory=dict)
    seeds: list[Count] = field(default_factory=lambda: [0])
    hints: PositiveInt = 15
    hint_counts: list[Count] = field(default_factory=lambda: [0, 5, 10, 20, 50])
    hint_seed: Count = 0
    checkpoint: Literal["best", "last"] = "best"
    gallery: PositiveInt = 4
    reference: str | None = None
    placements: list[Placement] = field(default_factory=list)
    placement_counts: list[Count] = field(default_factory=list)
    noise_degrees: list[NonNegative] = field(default_factory=list)
    noise_pixels: list[NonNegative] = field(default_factory=list)
    pins: Count = 0
    metrics: list[str | dict[str, Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        check_ranges(self)
        for name in ("rows", "seeds"):
            if not getattr(self, name):
                raise InputError(f"a plan needs {name}, but the list is empty.")
        other = [name for name in self.test_data if name not in _TEST_DATA]
        if other:
            raise InputError(f"test_data of a plan can only have {', '.join(_TEST_DATA)}, not {other[0]}.")
        if bool(self.placements) != bool(self.placement_counts):
            raise InputError("a plan has placements if and only if it has placement_counts.")
        twice = [name for name, times in Counter(row.name for row in self.rows).items() if times > 1]
        if twice:
            raise InputError(f"two rows of the plan are named {twice[0]}; names must be unique.")
        if self.reference is not None:
            self.row(self.reference)

    @property
    def noise(self) -> dict[str, tuple[float, float]]:
        """The errors of hints in degrees and pixels, by the name of their figures."""
        turned = {f"degrees-{degrees:g}": (degrees, 0.0) for degrees in self.noise_degrees}
        return turned | {f"pixels-{pixels:g}": (0.0, pixels) for pixels in self.noise_pixels}

    @property
    def counts(self) -> list[int]:
        """All numbers of hints that are measured, in ascending order."""
        return sorted({0, self.hints, *self.hint_counts})

    def row(self, name: str) -> Row:
        """Return the row with a name.

        Raises:
            InputError: if there is no such row.
        """
        for row in self.rows:
            if row.name == name:
                return row
        raise InputError(f"the plan has no row {name}; it has {', '.join(row.name for row in self.rows)}.")


def is_plan(path: str | Path) -> bool:
    """Return whether a configuration is a plan, that is, has rows or a base.

    Raises:
        InputError: if the file is not a readable configuration.
    """
    return not {"rows", "base"}.isdisjoint(read_yaml(path))


def read_plan(path: str | Path) -> Plan:
    """Return the plan in a file.

    ``base`` names another plan in the same folder, which provides missing fields and the first rows.

    Raises:
        InputError: if something in the plan is invalid; the message names the file and the row.
    """
    content, rows = _with_base(Path(path), ())
    return _read(Plan, {**content, "rows": rows}, f"the plan {path}")


def _with_base(path: Path, above: tuple[Path, ...]) -> tuple[Settings, list[Row]]:
    """Return the settings and rows of a plan, including its base's; ``above`` are the plans based on it."""
    path = Path(find_config(str(path)))  # a base is in the same folder, also in the package
    if path.resolve() in above:
        raise InputError(f"the plan {path} is its own base; a base must be another plan.")
    content = read_yaml(path)
    settings: Settings = {}
    rows: list[Row] = []
    base = content.pop("base", None)
    if base is not None:
        if not isinstance(base, str):
            raise InputError(f"the base of the plan {path} must be the name of a plan, not {base!r}.")
        settings, rows = _with_base(Path(_beside(path, base)), (*above, path.resolve()))
    own = content.pop("rows", [] if base is not None else None)
    if not isinstance(own, list) or not all(isinstance(row, dict) for row in own):
        raise InputError(f"the rows of the plan {path} are not a list of settings.")
    read = [
        _read(Row, row, f"the row {row.get('name', i + 1)} of the plan {path}") for i, row in enumerate(own)
    ]
    read = [replace(row, configs=[_beside(path, name) for name in row.configs]) for row in read]
    return {**settings, **content}, [*rows, *read]


def _beside(plan: Path, name: str) -> str:
    """Return the path of the named file next to the plan if it exists, otherwise the name itself."""
    beside = plan.parent / name
    return str(beside) if beside.is_file() else name


def read_yaml(path: str | Path) -> Settings:
    """Return the settings of a user's or shipped configuration file.

    Raises:
        InputError: if the file is not a readable configuration.
    """
    path = find_config(str(path))
    check_config(path)
    content: Settings = load_yaml(Path(path).read_text(encoding="utf-8"))
    return content


def _read(kind: type[Part], content: Settings, where: str) -> Part:
    try:
        return read_record(kind, content)
    except InputError as error:
        raise InputError(f"{where} cannot be used: {error}") from error
