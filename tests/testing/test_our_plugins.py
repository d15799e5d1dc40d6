"""Every plug-in of ours through the kit, with default settings if none are listed here."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import torch
from opengl_here import needs_opengl

import normalgan
from normalgan.data.augmentation import AUGMENTATIONS, Augmentation
from normalgan.hints import (
    HINT_SAMPLERS,
    CurvatureHints,
    FarthestPointHints,
    NoHints,
    UniformHints,
    WorstErrorHints,
)
from normalgan.inference.outputs import OUTPUTS, Height, Preview, Relief
from normalgan.losses import (
    ADVERSARIAL_OBJECTIVES,
    RECONSTRUCTIONS,
    AngularLikelihood,
    CosineAndL2,
    CrossEntropy,
    L1AndHints,
    Wasserstein,
    WassersteinGradientPenalty,
)
from normalgan.metrics import (
    METRICS,
    MeanAngularError,
    MeanAngularErrorPerImage,
    MeanL1,
    MeanL2,
    MedianAngularError,
    RootMeanSquareAngularError,
    ShareBelow,
)
from normalgan.models import (
    DISCRIMINATORS,
    GENERATORS,
    GlobalDiscriminator,
    PatchDiscriminator,
    ResidualUNetGenerator,
    TiledGenerator,
    UNetDiscriminator,
    UNetGenerator,
)
from normalgan.registry import Registry
from normalgan.rendering.lines import (
    LINE_DRAWINGS,
    Brush,
    Mixture,
    ObjectSpaceSuggestive,
    OccludingContours,
    RidgesAndValleys,
    Silhouette,
    SuggestiveContours,
)
from normalgan.rendering.renderers import RENDERERS, EmbreeRenderer, PyrenderRenderer
from normalgan.testing import Check, checks

torch.set_num_threads(1)  # networks this small are slower with more

OURS: list[tuple[Registry[Any], list[Any]]] = [
    (
        HINT_SAMPLERS,
        [
            CurvatureHints(),
            CurvatureHints(dropout=0.0),
            CurvatureHints(count=7),
            FarthestPointHints(7),
            WorstErrorHints(7),
            NoHints(),
            UniformHints(3, 20),
            UniformHints(none=0.5),
        ],
    ),
    (
        GENERATORS,
        [
            UNetGenerator(64, 4),
            ResidualUNetGenerator((4, 8, 8), (1, 1, 1), norm="batch"),
            TiledGenerator(16, (4, 8), (1, 1)),
        ],
    ),
    (
        DISCRIMINATORS,
        [
            UNetDiscriminator(64, 4),
            UNetDiscriminator(64, 4, encoder_head=True, see_mask=True),
            PatchDiscriminator(4),
            GlobalDiscriminator(64, 4),
        ],
    ),
    (ADVERSARIAL_OBJECTIVES, [CrossEntropy(), Wasserstein(), WassersteinGradientPenalty()]),
    (RECONSTRUCTIONS, [L1AndHints(), AngularLikelihood(), CosineAndL2()]),
    (
        AUGMENTATIONS,
        [
            Augmentation(),
            Augmentation(stretch=True, shear=10.0),
            Augmentation(fills=1.0, decals=1.0, hatching=1.0),
        ],
    ),
    (
        METRICS,
        [
            MeanAngularError(),
            MeanAngularErrorPerImage(),
            MeanL1(),
            MeanL2(),
            MedianAngularError(),
            RootMeanSquareAngularError(),
            ShareBelow(7.5),
        ],
    ),
    (
        OUTPUTS,
        [
            *(output() for output in OUTPUTS if output.__module__.startswith("normalgan.")),
            Height("tiff"),
            Height(height_scale=20.0),
            Preview("gif"),
            Relief("obj", faces=500),
        ],
    ),
    (RENDERERS, [EmbreeRenderer(), PyrenderRenderer()]),
    (
        LINE_DRAWINGS,
        [
            Brush(resolution=192),
            Mixture([Silhouette(), OccludingContours(resolution=192)], [1, 2]),
            ObjectSpaceSuggestive(resolution=192),
            OccludingContours(resolution=192, crease=30),
            RidgesAndValleys(resolution=192),
            Silhouette(resolution=192),
            SuggestiveContours(resolution=192),
        ],
    ),
]
for _registry, _listed in OURS:
    _others = {cls for cls in _registry if cls.__module__.startswith("normalgan.")} - set(map(type, _listed))
    _listed += [cls() for cls in sorted(_others, key=lambda cls: cls.__name__)]


def asked() -> Iterator[Any]:
    """Yield each plug-in with each check of its kind, as a case of its own."""
    for _, plugins in OURS:
        for i, plugin in enumerate(plugins):
            marks = [needs_opengl] if isinstance(plugin, PyrenderRenderer) else []
            for check in checks(type(plugin)):
                yield pytest.param(plugin, check, id=f"{type(plugin).__name__}{i}-{check}", marks=marks)


@pytest.mark.parametrize(("plugin", "check"), list(asked()))
def test_ours_do_what_is_asked_of_others(plugin: Any, check: Check[Any]) -> None:
    check(plugin)


@pytest.mark.parametrize(("registry", "plugins"), OURS, ids=lambda x: "")
def test_none_of_ours_is_forgotten(registry: Registry[Any], plugins: list[Any]) -> None:
    ours = {cls.__name__ for cls in registry if cls.__module__.startswith("normalgan.")}
    assert {type(plugin).__name__ for plugin in plugins} == ours


def test_each_module_of_plugins_is_imported_by_its_package() -> None:
    source, found = Path(normalgan.__file__).parent, []
    for path in source.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if re.search(r"^@[A-Z_]+\.register$", text, re.MULTILINE) and "Registry(" not in text:
            name = ".".join(["normalgan", *path.relative_to(source).with_suffix("").parts])
            assert name in path.with_name("__init__.py").read_text(encoding="utf-8"), name
            found.append(name)
    assert "normalgan.hints.uniform" in found
