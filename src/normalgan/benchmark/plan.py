"""Plan: the rows and settings of a benchmark, read from a YAML file and checked."""

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

__all__ = ["Placement", "Plan", "Row", "Settings", "is_plan", "read_plan", "read_yaml"]

Settings = dict[str, Any]
_DRAWN = ("hand", "lines", "medium")
_MESHES = ("meshes", "reading", "split", "test_views")
_TEST_DATA = (*_DRAWN, *_MESHES)
"""Settings of the data that may be others for the test split; its size is that of the networks."""
Placement = Literal["uniform", "curvature", "farthest", "worst"]
"""See `normalgan.benchmark.hints`, which needs torch."""
Part = TypeVar("Part", "Plan", "Row")


@dataclass(frozen=True)
class Row(Record):
    """A line of the table: a trained method, or one without training.

    The settings of a trained method are composed as for `normalgan fit`, and later ones win: its configs, its
    changes, the data of the plan, the overlays of the scale, its settings.

    Args:
        name: name of its folder.
        label: in tables and pictures.
        group: heading in tables.
        classical: a method without training.
        configs: files that it is put together from; relative to the plan, or else to the working directory.
        changes: settings, in dots, before the overlays of the scale.
        settings: settings, in dots, that win over these.
        takes: settings of the overlays that it takes, in dots; None takes all.
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
            raise InputError(f"the row {self.name} is classical and has no settings, changes or takes.")


@dataclass(frozen=True)
class Plan(Record):
    """A benchmark.

    Args:
        name: in reports.
        images: number of training images of each generator, with repetitions.
        rows: what is compared.
        data: settings of the data that all rows share.
        test_data: settings of data that differ for the test split: how it is drawn, or other meshes.
        seeds: seeds of initialisation, training hints and dropout; a run for each.
        hints: how many hints table 1 gives.
        hint_counts: numbers of hints in the curve; 0 and ``hints`` are always measured.
        hint_seed: seed of the test hints.
        checkpoint: which one is measured: the ``best`` on the validation split, or the ``last``.
        gallery: test samples in the gallery.
        reference: name of the row that every panel of the curves shows.
        placements: ways of placing hints that all methods are tested with, at equal counts.
        placement_counts: how many hints each placement gives.
        noise_degrees: by how much hints of table 1 are turned, in tests of hints that are off.
        noise_pixels: by how much they are moved.
        pins: number of pins that a simulated user gives in turn; 0 tests none.
        metrics: other metrics that are measured, each a name or a ``class_path`` with ``init_args``.
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
                raise InputError(f"a plan needs {name}, but its list of them is empty.")
        other = [name for name in self.test_data if name not in _TEST_DATA]
        if other:
            raise InputError(f"test_data of a plan has {', '.join(_TEST_DATA)} alone, not {other[0]}.")
        if bool(self.placements) != bool(self.placement_counts):
            raise InputError("a plan has placements if and only if it has placement_counts.")
        twice = [name for name, times in Counter(row.name for row in self.rows).items() if times > 1]
        if twice:
            raise InputError(f"two rows of the plan are named {twice[0]}; each needs a name of its own.")
        if self.reference is not None:
            self.row(self.reference)

    @property
    def noise(self) -> dict[str, tuple[float, float]]:
        """Errors of hints in degrees and pixels, by the name of their figures."""
        turned = {f"degrees-{degrees:g}": (degrees, 0.0) for degrees in self.noise_degrees}
        return turned | {f"pixels-{pixels:g}": (0.0, pixels) for pixels in self.noise_pixels}

    @property
    def counts(self) -> list[int]:
        """The numbers of hints that are measured, in ascending order."""
        return sorted({0, self.hints, *self.hint_counts})

    def row(self, name: str) -> Row:
        """Return the row of a name.

        Raises:
            InputError: if there is none.
        """
        for row in self.rows:
            if row.name == name:
                return row
        raise InputError(f"the plan has no row {name}; it has {', '.join(row.name for row in self.rows)}.")


def is_plan(path: str | Path) -> bool:
    """Return whether a configuration is a plan: it has rows, or takes another plan's.

    Raises:
        InputError: if it cannot be read as a configuration.
    """
    return not {"rows", "base"}.isdisjoint(read_yaml(path))


def read_plan(path: str | Path) -> Plan:
    """Return the plan of a file.

    Its ``base`` names another plan in the same folder, which provides missing fields and the first rows.

    Raises:
        InputError: if something in it cannot be used; the sentence names the file and the row.
    """
    content, rows = _with_base(Path(path), ())
    return _read(Plan, {**content, "rows": rows}, f"the plan {path}")


def _with_base(path: Path, above: tuple[Path, ...]) -> tuple[Settings, list[Row]]:
    """Return settings and rows of a plan, including its base's; ``above`` are the plans based on it."""
    path = Path(find_config(str(path)))  # its base lies beside it, in the package too
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
    """Return the file of this name next to the plan, or else the name itself."""
    beside = plan.parent / name
    return str(beside) if beside.is_file() else name


def read_yaml(path: str | Path) -> Settings:
    """Return the settings of a configuration file, the user's or the package's.

    Raises:
        InputError: if it cannot be read as one.
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
