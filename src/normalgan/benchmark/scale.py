"""Scale: the sizes of networks and pictures in a benchmark, and the time budget."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from normalgan.benchmark.plan import Settings, read_yaml
from normalgan.benchmark.settings import MACHINE, flatten, nest, without
from normalgan.errors import InputError

_UNITS = {"h": 3600, "m": 60, "s": 1}


@dataclass(frozen=True)
class Scale:
    """Settings that overlay all rows of a plan.

    Args:
        name: name of the scale in every result.
        overlays: settings of `normalgan fit`, of which a row may take only some; later overlays win.
        given: data and trainer settings that override all others.
        seconds: wall-clock budget of a run; None uses the plan's number of images.
    """

    name: str
    overlays: tuple[Settings, ...] = ()
    given: Mapping[str, Any] | None = None
    seconds: float | None = None

    @property
    def changed(self) -> dict[str, Any]:
        """The given settings that change figures, by their dotted names."""
        return flatten(without(self.given or {}, MACHINE))


def read_scale(paths: Sequence[str | Path], given: Sequence[str] = (), seconds: float | None = None) -> Scale:
    """Return the scale of some overlays, which is named after them.

    Args:
        paths: files with settings of `normalgan fit`.
        given: data and trainer settings as ``name=value``, with the value in YAML.
        seconds: wall-clock budget of a run, or None.

    Raises:
        InputError: if a file or setting is invalid.
    """
    name = "+".join(Path(path).stem for path in paths) or "published"
    return Scale(name, tuple(read_yaml(path) for path in paths), _given(given), seconds)


def read_budget(text: str) -> float:
    """Return a duration such as ``1h30m`` in seconds.

    Raises:
        InputError: if the text is not a duration.

    >>> [read_budget(text) for text in ("8m", "90s", "1h30m", "0.5h")]
    [480.0, 90.0, 5400.0, 1800.0]
    """
    parts = re.findall(r"(\d+(?:\.\d+)?)([hms])", text)
    if not parts or "".join(number + unit for number, unit in parts) != text:
        raise InputError(f"the budget {text!r} is not a duration; write it like 8m, 90s or 1h30m.")
    seconds = sum(float(number) * _UNITS[unit] for number, unit in parts)
    if seconds <= 0:
        raise InputError(f"the budget {text!r} must be more than zero; write it like 8m, 90s or 1h30m.")
    return float(seconds)


def _given(settings: Sequence[str]) -> Settings:
    dotted: Settings = {}
    for text in settings:
        name, equals, value = text.partition("=")
        if not equals or not re.fullmatch(r"(data|trainer)(\.\w+)+", name):
            raise InputError(
                f"--set was given {text!r}; write settings of data or trainer, like data.size=64."
            )
        try:
            dotted[name] = yaml.safe_load(value)
        except yaml.YAMLError:
            raise InputError(f"--set was given {text!r}, whose value is not YAML.") from None
    return nest(dotted)
