"""Findings: warnings and remarks about a map, as data; `words_of` returns the text for the command line."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal

from normalgan.errors import InputError

Code = Literal[
    "edge", "empty_mask", "figures", "guessed", "hints", "no_lines", "no_object", "note", "regions", "unseen"
]
_FEW = 3
"""Maximum number of places that a message lists."""


@dataclass(frozen=True)
class Finding:
    """A finding about a map or its drawing.

    Args:
        code: kind of the finding; see `words_of`.
        places: x and y of the affected places in pixels of the drawing, the most important first.
        count: number of affected items.
        total: total number of items.
        share: fraction in [0, 1], whose meaning depends on the code.
        layer: name of the layer; empty if there is only one.
        words: text of the finding if its code has no text; a sentence or part of one.
    """

    code: Code
    places: tuple[tuple[float, float], ...] = ()
    count: int = 0
    total: int = 0
    share: float = 0.0
    layer: str = ""
    words: str = ""


class LackingError(InputError):
    """Raised if a drawing lacks something that prediction needs.

    Args:
        words: sentence that says what is missing.
        code: code of the corresponding finding.
        layer: name of the layer; empty if there is only one.
    """

    def __init__(self, words: str, code: Code = "note", layer: str = "") -> None:
        self.finding = Finding(code, layer=layer, words=words)
        super().__init__(words_of(self.finding))


def words_of(finding: Finding) -> str:
    """Return the text of a finding, as part of a sentence.

    >>> words_of(Finding("edge", ((3.2, 8),), layer="Arm"))
    'Arm: no line bounds the object near x 3, y 8, so its edge is a guess; close it if it is wrong'
    """
    own = _WORDS.get(finding.code)
    words = finding.words if own is None else own(finding)
    return f"{finding.layer}: {words}" if finding.layer else words


def finding_of(error: InputError) -> Finding:
    """Return an error about a drawing as a finding."""
    return error.finding if isinstance(error, LackingError) else Finding("note", words=str(error))


def join(findings: Iterable[Finding]) -> str:
    """Return the texts of findings without duplicates, as part of a sentence; empty if there are none."""
    return "; ".join(dict.fromkeys(words_of(each).removesuffix(".") for each in findings))


def _hints(finding: Finding) -> str:
    more = f" and {finding.count - _FEW} more" if finding.count > _FEW else ""
    lie, them = ("lies", "it") if finding.count == 1 else ("lie", "them")
    return (
        f"{finding.count} of {finding.total} hints {lie} off the object, at {_places(finding)}{more}; "
        f"move {them} onto it, or give --mask if the mask is wrong"
    )


def _regions(finding: Finding) -> str:
    what = "a region" if finding.count == 1 else f"{finding.count} regions"
    return f"{what} may be object or hole, at {_places(finding)}; flip one with --hole x,y if it is wrong"


def _places(finding: Finding) -> str:
    return "; ".join(f"x {x:.0f}, y {y:.0f}" for x, y in finding.places[:_FEW])


_WORDS: dict[Code, Callable[[Finding], str]] = {
    "edge": lambda finding: (
        f"no line bounds the object near {_places(finding)}, so its edge is a guess; close it if it is wrong"
    ),
    "figures": lambda finding: (
        f"it shows {finding.count} separate figures, such as at {_places(finding)}, predicted as one object; "
        "put each on its own layer"
    ),
    "guessed": lambda _: (
        "no object was found among its lines, so the network guessed the mask; "
        "close the outline, or give --mask"
    ),
    "hints": _hints,
    "regions": _regions,
    "unseen": lambda finding: (
        f"the model takes only {finding.share:.0%} of its mask for an object and is unsure of the rest"
    ),
}
