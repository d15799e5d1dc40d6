"""Ranges in annotations: numbers, optional ones, pairs and lists; every class that has one checks it."""

import inspect
import pkgutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib import import_module
from typing import Annotated, Any, Literal, get_args, get_type_hints

import pytest

import normalgan
from normalgan.errors import InputError
from normalgan.hints import NoHints
from normalgan.ranges import Count, Positive, PositiveInt, Range, UnitInterval, check_ranges


@dataclass(frozen=True)
class Pen:
    """Settings of every kind that has a range, and one without."""

    count: Count = 1
    width: Positive | None = None
    tilt: Annotated[float, Range(0, 90, below=True)] = 0.0
    strength: Annotated[tuple[float, float], Range(0, 1)] = (0.0, 1.0)
    shares: list[UnitInterval] = field(default_factory=list)
    name: str = "pen"
    tip: Literal["round", "flat"] | None = None
    tips: list[Literal["round", "flat"]] = field(default_factory=list)
    spacing: Positive | Literal["auto"] = "auto"

    def __post_init__(self) -> None:
        check_ranges(self)


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        ({"count": -1}, "count of Pen is -1; it must be 0 or more."),
        ({"count": 10**400}, "; it must be 0 or more."),  # no number of a computer's
        ({"width": 0}, "width of Pen is 0; it must be more than 0."),
        ({"width": float("inf")}, "width of Pen is inf; it must be more than 0."),
        ({"width": float("nan")}, "width of Pen is nan; it must be more than 0."),
        ({"tilt": 90}, "tilt of Pen is 90; it must be from 0 to below 90."),
        ({"strength": (0.6, 0.5)}, "strength of Pen is (0.6, 0.5); it must be two numbers"),
        ({"strength": (0.5,)}, "strength of Pen is (0.5,); it must be two numbers"),
        ({"strength": (0.5, 2)}, "two numbers, low then high, from 0 to 1."),
        ({"spacing": 0}, "spacing of Pen is 0; it must be more than 0."),
        ({"tip": "soft"}, "tip of Pen is 'soft'; it must be 'round' or 'flat'."),
        ({"tips": ["flat", "soft"]}, "each must be 'round' or 'flat'."),
        ({"shares": [0.5, 2]}, "shares of Pen is [0.5, 2]; each must be from 0 to 1."),
    ],
)
def test_what_lies_outside_a_range_is_told(settings: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        Pen(**settings)  # type: ignore[arg-type]
    assert str(caught.value).startswith(sentence) or str(caught.value).endswith(sentence)


def test_what_lies_inside_passes() -> None:
    Pen(0, 0.1, 89.9, (0.0, 0.0), [0.0, 1.0], "pen", "flat", ["flat"], 0.5)


def test_a_class_may_give_its_values_by_name() -> None:
    class Brush:
        def __init__(self, count: Count) -> None:
            check_ranges(self, {"count": count})

    with pytest.raises(InputError, match="count of Brush is -2; it must be 0 or more"):
        Brush(-2)


def test_a_plugin_is_checked_without_a_constructor_of_its_own() -> None:
    @dataclass(frozen=True)
    class GridHints(NoHints):
        spacing: PositiveInt = 16

    with pytest.raises(InputError, match="spacing of GridHints is 0; it must be 1 or more"):
        GridHints(0)


def has_range(hint: Any) -> bool:
    metadata = getattr(hint, "__metadata__", ())
    return any(isinstance(each, Range) for each in metadata) or any(map(has_range, get_args(hint)))


def checks(kind: type) -> bool:
    """Return whether a method that runs when an object is made calls `check_ranges`."""
    made = [vars(base).get(name) for base in kind.__mro__ for name in ("__init__", "__post_init__")]
    return any("check_ranges" in each.__code__.co_names for each in made if inspect.isfunction(each))


def classes_with_ranges() -> Iterator[type]:
    """Yield the classes of the package that annotate a setting with a range.

    The body plans of animals are left out: what reads a species file checks them.
    """
    for module in pkgutil.walk_packages(normalgan.__path__, "normalgan."):
        # The first would run, and the second is imported by a child process under another name.
        if module.name.startswith(("normalgan.__main__", "normalgan.decoding.", "normalgan.animals.")):
            continue
        for _, kind in inspect.getmembers(import_module(module.name), inspect.isclass):
            if kind.__module__ == module.name and "Annotated" in str(inspect.signature(kind.__init__)):
                hints = get_type_hints(kind.__init__, include_extras=True)
                if any(map(has_range, hints.values())):
                    yield kind


@pytest.mark.filterwarnings("ignore")  # of libraries, as they are imported
def test_every_class_that_declares_a_range_checks_it() -> None:
    found = list(classes_with_ranges())
    assert len(found) > 40
    assert [kind.__name__ for kind in found if not checks(kind)] == []
