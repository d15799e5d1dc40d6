"""Every setting that has a range is held to it; the ranges themselves stand in the classes."""

from typing import Annotated, Any, get_args, get_origin, get_type_hints

import pytest

from normalgan.errors import InputError
from normalgan.ranges import Range
from normalgan.rendering.cameras import Views
from normalgan.rendering.hand import Hand
from normalgan.rendering.lines import LINE_DRAWINGS, Mixture, Silhouette
from normalgan.rendering.media import Medium
from normalgan.rendering.mesh_files import MeshFile
from normalgan.rendering.renderers import EmbreeRenderer
from normalgan.rendering.rigs import RiggedFile
from normalgan.rendering.samples import Recipe
from normalgan.rendering.variation import Variation, Varied

COW = MeshFile("cow.off")
REQUIRED: dict[Any, dict[str, Any]] = {
    **{kind: {} for kind in (Views, Hand, Medium, Variation, *LINE_DRAWINGS) if kind is not Mixture},
    MeshFile: {"path": "cow.off"},
    RiggedFile: {"file": COW, "pose": 0},
    Varied: {"source": COW, "variation": Variation(), "number": 0},
    Recipe: {"views": Views(), "renderer": EmbreeRenderer(), "lines": Silhouette()},
}


def outside(hint: Any) -> list[Any]:
    """Return values just outside the range of an annotation; none if it has no range."""
    if get_origin(hint) is not Annotated:
        return [value for each in get_args(hint) for value in outside(each)]
    allowed = next(each for each in hint.__metadata__ if isinstance(each, Range))
    low = allowed.least if allowed.above else allowed.least - 1
    high = allowed.most if allowed.below else allowed.most + 1
    return [(low, high)] if get_origin(get_args(hint)[0]) is tuple else [low, high]


@pytest.mark.parametrize("kind", REQUIRED, ids=lambda kind: kind.__name__)
def test_every_setting_is_held_to_its_range(kind: Any) -> None:
    hints = get_type_hints(kind.__init__, include_extras=True)
    refused = [(name, value) for name, hint in hints.items() for value in outside(hint)]
    assert refused
    for name, value in refused:
        with pytest.raises(InputError, match=f"^{name} of {kind.__name__} is "):
            kind(**{**REQUIRED[kind], name: value})
