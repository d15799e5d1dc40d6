"""Ranges in annotations: numbers, optional ones, pairs and lists, in dataclasses and other classes."""

from dataclasses import dataclass, field
from typing import Annotated, Literal

import pytest

from normalgan.errors import InputError
from normalgan.ranges import Count, Positive, Range, Share, check_ranges


@dataclass(frozen=True)
class Pen:
    """Settings of every kind that has a range, and one without."""

    count: Count = 1
    width: Positive | None = None
    tilt: Annotated[float, Range(0, 90, below=True)] = 0.0
    strength: Annotated[tuple[float, float], Range(0, 1)] = (0.0, 1.0)
    shares: list[Share] = field(default_factory=list)
    name: str = "pen"
    tip: Literal["round", "flat"] | None = None
    spacing: Positive | Literal["auto"] = "auto"

    def __post_init__(self) -> None:
        check_ranges(self)


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        ({"count": -1}, "count of Pen is -1; it must be 0 or more."),
        ({"width": 0}, "width of Pen is 0; it must be more than 0."),
        ({"width": float("inf")}, "width of Pen is inf; it must be more than 0."),
        ({"width": float("nan")}, "width of Pen is nan; it must be more than 0."),
        ({"tilt": 90}, "tilt of Pen is 90; it must be from 0 to below 90."),
        (
            {"strength": (0.6, 0.5)},
            "strength of Pen is (0.6, 0.5); it must be two numbers",
        ),
        ({"strength": (0.5,)}, "strength of Pen is (0.5,); it must be two numbers"),
        ({"strength": (0.5, 2)}, "two numbers, low then high, from 0 to 1."),
        ({"spacing": 0}, "spacing of Pen is 0; it must be more than 0."),
        ({"tip": "soft"}, "tip of Pen is 'soft'; it must be 'round' or 'flat'."),
        ({"shares": [0.5, 2]}, "shares of Pen is [0.5, 2]; each number must be from 0 to 1."),
    ],
)
def test_what_lies_outside_a_range_is_told(settings: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        Pen(**settings)  # type: ignore[arg-type]
    assert str(caught.value).startswith(sentence) or str(caught.value).endswith(sentence)


def test_what_lies_inside_passes() -> None:
    Pen(0, 0.1, 89.9, (0.0, 0.0), [0.0, 1.0], "pen", "flat", 0.5)


def test_a_class_may_give_its_values_by_name() -> None:
    class Brush:
        def __init__(self, count: Count) -> None:
            check_ranges(self, {"count": count})

    with pytest.raises(InputError, match="count of Brush is -2; it must be 0 or more"):
        Brush(-2)
