"""The kit on broken plug-ins of every kind: each fault is told in one sentence; the others pass."""

import random
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from broken import broken
from torch import Tensor, nn
from torch.nn.utils.parametrizations import spectral_norm

from normalgan.animals import make_animals
from normalgan.batch import Batch
from normalgan.data.augmentation import BatchAugmentation
from normalgan.data.recipe import Loadable
from normalgan.data.sources import DataSource, Pairs, SplitSettings
from normalgan.errors import InputError
from normalgan.hints import HintSampler
from normalgan.losses import AdversarialObjective, Reconstruction, Scores, Term
from normalgan.metrics import MapMetric, angular_error
from normalgan.models import Discriminator, Generator, Predictions, UNetGenerator
from normalgan.rendering import Camera, EmbreeRenderer, Maps, Mesh, Renderer
from normalgan.rendering.lines import LineDrawing, Silhouette
from normalgan.rendering.strokes import Stroke
from normalgan.rendering.view import View
from normalgan.testing import ConformanceError, check, checks
from pairs_on_disk import write_pairs

torch.set_num_threads(1)
HERE = globals()
Cases = list[tuple[type[Any], str]]
"""Broken plug-ins, and the sentence of the kit."""


# Hint samplers


class Sampler(HintSampler):
    """Gives every fourth pixel of the object, as it should."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        where = torch.zeros_like(normal[:, :1])
        where[..., ::2, ::2] = 1
        return where * mask


def at_least_one(right: Any, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Any:
    where = right(normal, mask, rng)
    where[:, 0, 0, 0] = torch.where(mask.sum((1, 2, 3)) > 0, where[:, 0, 0, 0], 1)
    return where


def of_its_own_state(right: Any, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Any:
    own = torch.Generator()
    own.seed()
    return right(normal, mask, rng) * (torch.rand(mask.shape, generator=own) > 0.5)


def quota(right: Any, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Any:
    where = right(normal, mask, rng)
    return where * (where.flatten().cumsum(0).view(where.shape) <= 60)


def into_the_mask(right: Any, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Any:
    where = right(normal, mask, rng)
    mask[..., ::2] = 0
    return where * mask


SAMPLERS = broken(
    *(Sampler, "sample", HERE),
    {
        "Flat": (
            lambda right, *given: right(*given)[:, 0],
            r"gave a tensor \(2, 32, 32\); hints are a tensor \(2, 1, 32, 32\) here",
        ),
        "ListOfHints": (lambda right, *given: list(right(*given)), "gave a list of .*; hints are a tensor"),
        "WholeNumbers": (
            lambda right, *given: right(*given).long(),
            r"returned torch.int64 for normals of torch.float32; it must return the dtype of the normals.",
        ),
        "Half": (
            lambda right, *given: right(*given) / 2,
            "gave hints with the value 0.5; hints are a tensor .* 1 at a hinted pixel and 0 elsewhere",
        ),
        "Everywhere": (
            lambda right, normal, mask, rng: torch.ones_like(mask),
            r"gave \d+ hints off the object; hints must lie where mask is 1",
        ),
        "AtLeastOne": (at_least_one, "gave 1 hints to a picture without an object; it must return no hints"),
        "Divides": (
            lambda right, normal, mask, rng: (
                [1 / int(one.sum()) for one in mask] and right(normal, mask, rng)
            ),
            "raised ZeroDivisionError .* when asked for pictures without an object; a picture without",
        ),
        "Leaves": (lambda *_: sys.exit(0), r"raised SystemExit \(0\) when asked for shape and type"),
        "Square": (
            lambda right, normal, mask, rng: right(normal, mask, rng) * torch.ones(2 * mask.shape[-1:]),
            "raised RuntimeError .* when asked for batches of other sizes; all sizes of pictures",
        ),
        "Moody": (
            of_its_own_state,
            "returned another output for the same seed; all randomness must come from rng",
        ),
        "SeedsPython": (
            lambda right, *given: random.seed(1) or right(*given),
            "drew from or seeded Python's global random state; all randomness must come from the given",
        ),
        "DrawsFromNumpy": (
            lambda right, *given: 0 * np.random.rand() + right(*given),  # noqa: NPY002
            "drew from or seeded numpy's global random state",
        ),
        "DrawsFromTorch": (
            lambda right, *given: 0 * torch.rand(1) + right(*given),
            "drew from or seeded torch's global random state",
        ),
        "Quota": (
            quota,
            "changed the hints of a sample when another sample of the batch was changed; a sample must not",
        ),
        "IntoTheMask": (into_the_mask, "changed the tensors it was given; they belong to the caller"),
    },
)


# The settings of any kind


class Undocumented(Sampler):
    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        return super().sample(normal, mask, rng)


@dataclass(frozen=True)
class Mysterious(Sampler):
    """Has a setting that nobody explains."""

    spacing: int = 2


class Untyped(Sampler):
    """Has a setting without a type.

    Args:
        spacing: between hints.
    """

    def __init__(self, spacing=2) -> None:  # type: ignore[no-untyped-def]
        self.spacing = spacing


@dataclass(frozen=True)
class Holding(Sampler):
    """Has a setting that YAML cannot hold.

    Args:
        pattern: of hints.
    """

    pattern: Any = field(default_factory=lambda: torch.ones(2))


@dataclass
class Growing(Sampler):
    """Changes its settings.

    Args:
        spacing: between hints.
    """

    spacing: int = 2

    def __post_init__(self) -> None:
        self.spacing += 1


class Locked(Sampler):
    """Opens a file that no other process can have."""

    def __init__(self) -> None:
        self.file = open(__file__)  # noqa: PTH123, SIM115

    def __del__(self) -> None:
        self.file.close()


class _Private(Sampler):
    """Has a name that jsonargparse hides."""


SETTINGS: Cases = [
    (Undocumented, "Undocumented has no docstring of its own; --help and normalgan plugins show"),
    (
        Mysterious,
        "Mysterious does not explain spacing in its docstring; the docstring of the class needs a line",
    ),
    (Untyped, "Untyped has a setting spacing without a type; the command line reads the type"),
    (Holding, "Holding .*; settings must be"),
    (
        Growing,
        "Growing is not equal after being rebuilt from its own settings; its fields must be its settings",
    ),
    (Locked, "Locked raised TypeError .* when asked for pickling for another process; it must survive"),
    (_Private, "_Private has a part that begins with an underscore in its path"),
]


class Passing(UNetGenerator):
    """Passes its settings on to its base, whose docstring explains them."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)


def test_settings_that_are_passed_on_need_no_words_of_their_own() -> None:
    check(Passing(size=32, width=4), size=32)


# Networks


class Network(Generator):
    """A convolution, as a generator should be."""

    def __init__(self) -> None:
        super().__init__()
        self.conv = nn.Conv2d(4, 3, 3, padding=1)

    def forward(self, condition: Tensor) -> Any:
        return torch.tanh(self.conv(condition))


class Spare(Network):
    """Has a layer that it never asks."""

    def __init__(self) -> None:
        super().__init__()
        self.spare = nn.Linear(1, 1)


class Forgets(Network):
    """Keeps a weight where no checkpoint finds it."""

    def __init__(self) -> None:
        super().__init__()
        self.register_buffer("gain", torch.tensor(0.5), persistent=False)

    def forward(self, condition: Tensor) -> Any:
        return torch.tanh(self.conv(condition) * self.gain)


class Counts(Network):
    """Scales by a number of Python that training changes, which no checkpoint holds."""

    def __init__(self) -> None:
        super().__init__()
        self.scale = 1.0

    def forward(self, condition: Tensor) -> Any:
        if self.training and torch.is_grad_enabled():
            self.scale *= 0.9
        return torch.tanh(self.conv(condition) * self.scale)


def unsure(right: Any, condition: Tensor) -> Any:
    predicted = right(condition)
    return torch.cat([predicted, predicted[:, :1] - 2], dim=1)


GENERATORS: Cases = [
    *broken(
        *(Network, "forward", HERE),
        {
            "TwoChannels": (
                lambda right, condition: right(condition)[:, :2],
                r"returns 2 channels; a model has 3, or 4 with the confidence",
            ),
            "AnswersInDoubles": (
                lambda right, condition: right(condition).double(),
                "returned torch.float64 for a condition of torch.float32; it must keep the dtype",
            ),
            "Loud": (
                lambda right, condition: right.__self__.conv(condition),
                r"predicted a component of .*; each component must be in \[-1, 1\], for example by tanh",
            ),
            "Unsure": (unsure, "predicted a confidence of 0 or less; the fourth channel must be above 0"),
            "Explodes": (
                lambda right, condition: right(condition) / (condition[:, 3:] * 0),
                "predicted values that are not finite; its output must be finite",
            ),
            "Lonely": (
                lambda right, condition: right(condition).view(
                    min(len(condition), 2), 3, *condition.shape[2:]
                ),
                "raised RuntimeError .* when asked for batches of any size; forward must return",
            ),
            "Cut": (
                lambda right, condition: (
                    right(condition).detach() + 0 * sum(p.sum() for p in right.__self__.parameters())
                ),
                "has only zero gradients; a loss on its output must reach its parameters",
            ),
            "Blind": (
                lambda right, condition: right(0 * condition),
                "ignores the condition; its output must depend on all inputs",
            ),
            "NoisyNetwork": (
                lambda right, condition: right(condition + torch.randn_like(condition)),
                "returns different outputs for the same input in evaluation; draw random numbers",
            ),
            "Mixes": (
                lambda right, condition: right(condition - condition.mean(0)),
                "differs by .* between a picture in a batch and the same picture alone; in evaluation",
            ),
            "Saturates": (  # bfloat16 rounds it to 1, where tanh has no slope
                lambda right, condition: torch.tanh(right.__self__.conv(condition) + 5),
                "has no finite gradient under mixed precision; it must be trainable in bfloat16",
            ),
        },
    ),
    *broken(
        *(Network, "predict", HERE),
        {
            "TrainsAnother": (
                lambda right, condition: Predictions(-right.__self__(condition).float()),
                "returns different values from predict and from forward; training and",
            ),
            "PlainTensor": (
                lambda right, condition: right.__self__(condition),
                r".predict gave a tensor \(2, 3, 64, 64\); it gives normalgan.models.predictions.Predictions",
            ),
            "Rounds": (
                lambda right, condition: Predictions(right.__self__(condition)),
                "predicts direction in torch.bfloat16 under mixed precision; the input of losses",
            ),
        },
    ),
    (Spare, "Spare gives no gradient to spare.weight, spare.bias; each parameter must affect"),
    (Forgets, "Forgets gives another output after its state_dict was loaded; keep all learnt"),
    (Counts, "Counts gives another output after its state_dict was loaded; keep all learnt"),
]


class Judge(Discriminator):
    """A convolution of both, as a discriminator should be."""

    def __init__(self) -> None:
        super().__init__()
        self.conv = nn.Conv2d(7, 1, 4, 4)

    def forward(self, condition: Tensor, normal: Tensor) -> Any:
        return (self.conv(torch.cat([condition, normal], dim=1)),)


class Spectral(Judge):
    """A convolution held Lipschitz by torch's own parametrisation, which cannot be pickled."""

    def __init__(self) -> None:
        super().__init__()
        spectral_norm(self.conv)


DISCRIMINATORS = broken(
    *(Judge, "forward", HERE),
    {
        "Bare": (
            lambda right, *given: right(*given)[0],
            "gave a tensor .*; a discriminator gives a tuple of scores",
        ),
        "Verdict": (
            lambda right, *given: (right(*given)[0].mean()[None],),
            r"gave a tuple of \(a tensor \(1,\)\); a discriminator gives",
        ),
        "Logarithm": (
            lambda right, *given: ((0 * right(*given)[0]).log(),),
            "gave a score that is not finite; scores must be finite",
        ),
        "LooksAway": (
            lambda right, condition, normal: right(condition, 0 * normal),
            "ignores the normals; its output must depend",
        ),
        "LooksAtTheMapAlone": (
            lambda right, condition, normal: right(0 * condition, normal),
            "ignores the condition; its output must depend",
        ),
    },
)


# Losses


class Plain(AdversarialObjective):
    """Means of scores, a head as much as another."""

    def discriminator_loss(self, real: Scores, fake: Scores) -> Any:
        return Plain.generator_loss(self, real) - Plain.generator_loss(self, fake)

    def generator_loss(self, fake: Scores) -> Any:
        return -torch.stack([score.mean() for score in fake]).mean()


def of_another_state(right: Any, critic: Any, real: Tensor, fake: Tensor) -> Any:
    own = torch.Generator()
    own.seed()
    return critic(real)[0].mean() * torch.rand((), generator=own)


@torch.no_grad()
def spoil(right: Any, discriminator: nn.Module) -> None:
    for parameter in discriminator.parameters():
        parameter.div_(0)


def fail(right: Any, discriminator: nn.Module) -> None:
    raise KeyError("norm")


OBJECTIVES: Cases = [
    *broken(
        *(Plain, "generator_loss", HERE),
        {
            "LossOfEachHead": (
                lambda right, fake: -torch.stack([score.mean() for score in fake]),
                r".generator_loss gave a tensor \(2,\); it gives a tensor of one number",
            ),
            "PythonNumber": (
                lambda right, fake: right(fake).item(),
                ".generator_loss gave a float; it gives a tensor of one number",
            ),
            "Detached": (
                lambda right, fake: right(fake).detach(),
                "returned a generator_loss without a gradient; both losses",
            ),
            "UpsideDown": (
                lambda right, fake: -right(fake),
                "does not lower generator_loss as scores rise; high scores mean true",
            ),
            "CountsElements": (
                lambda right, fake: -torch.cat([score.flatten() for score in fake]).mean(),
                "weights a head of 16 scores and a head of one score as .*; heads must have",
            ),
        },
    ),
    *broken(
        *(Plain, "discriminator_loss", HERE),
        {
            "Infinite": (
                lambda right, real, fake: right(real, fake) / 0,
                "returned (nan|-?inf) as discriminator_loss; discriminator_loss must be finite",
            ),
            "MixesScoresUp": (
                lambda right, real, fake: right(fake, real),
                "does not lower discriminator_loss as true maps score higher; the discriminator must",
            ),
            "HalfBlind": (
                lambda right, real, fake: right.__self__.generator_loss(real),
                "does not raise discriminator_loss as predicted maps score higher",
            ),
        },
    ),
    *broken(
        *(Plain, "penalty", HERE),
        {
            "OtherDice": (
                of_another_state,
                "returned different penalties for the same torch seed; draw random numbers only from torch",
            ),
            "FixedPenalty": (
                lambda right, critic, real, fake: real.new_ones(()),
                "returned a penalty without a gradient; it must teach the critic something",
            ),
        },
    ),
    *broken(
        *(Plain, "after_discriminator_step", HERE),
        {
            "Spoils": (
                spoil,
                "corrupted patches.weight of the discriminator; after_discriminator_step must keep",
            )
        },
    ),
    *broken(
        *(Plain, "check", HERE),
        {"Rude": (fail, "raised KeyError .* when asked for one-sentence errors; check may raise only")},
    ),
]


@dataclass(frozen=True)
class Squares(Reconstruction):
    """Squared differences on the object."""

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> Any:
        square = ((preds.normal - target).square() * mask).sum() / mask.sum().clamp(min=1)
        return {"square": Term(square, 1.0)}


RECONSTRUCTIONS = broken(
    *(Squares, "terms", HERE),
    {
        "Sum": (
            lambda right, *given: right(*given)["square"].value,
            r"gave a tensor \(\); a reconstruction loss gives its terms by name",
        ),
        "Unweighted": (
            lambda right, *given: {"square": right(*given)["square"].value},
            r"gave a tensor \(\) as square; a reconstruction loss gives its terms by name",
        ),
        "WholeMap": (
            lambda right, preds, target, *_: {"square": Term((preds.normal - target).square().mean(1), 1.0)},
            r"gave a tensor \(.*\) as square; a reconstruction loss gives its terms by name",
        ),
        "TakenName": (
            lambda right, *given: {"adversarial": right(*given)["square"]},
            "has a term named adversarial; training itself logs a term of this name; rename yours",
        ),
        "Negative": (
            lambda right, *given: {"square": right(*given)["square"]._replace(weight=-1.0)},
            "gives square the weight -1.0; weights must be 0 or more",
        ),
        "PointsAway": (
            lambda right, preds, target, *_: {"cosine": Term((preds.normal * target).sum(1).mean() + 1, 1.0)},
            "is .* for the true normals and .* for .*; the loss is minimised, so it must be smaller",
        ),
        "Steep": (  # its slope is infinite at 0
            lambda right, preds, target, *_: {
                "length": Term((preds.normal - target).square().sum(1).sqrt().mean(), 1.0)
            },
            "has a gradient that is infinite or nan at the true normals; a single infinite value would",
        ),
        "MeanOfNothing": (
            lambda right, preds, target, mask, where: {
                "square": Term(((preds.normal - target).square() * mask).sum() / mask.sum(), 1.0)
            },
            "is nan for pictures without an object or a hint; it must be finite",
        ),
    },
)


# Metrics, augmentations and sources


class Worst(MapMetric):
    """The largest error on the object."""

    unit = "°"
    worst: Tensor

    def __init__(self) -> None:
        super().__init__()
        self.add_state("worst", torch.tensor(0.0), dist_reduce_fx="max")

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Count a batch."""
        self.worst = torch.maximum(self.worst, (angular_error(preds, target) * mask).max())

    def compute(self) -> Tensor:
        """Return degrees."""
        return self.worst


class OfTheBatch(Worst):
    """Forgets all but the last batch."""

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Count a batch."""
        self.worst = (angular_error(preds, target) * mask).max()


class EverywhereMeasured(Worst):
    """Looks off the object too."""

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Count a batch."""
        self.worst = torch.maximum(self.worst, (preds - target).abs().max())


class Alone(Worst):
    """Does not say how processes join."""

    def __init__(self) -> None:
        super().__init__()
        self.add_state("worst", torch.tensor(0.0), dist_reduce_fx="sum")


METRICS: Cases = [
    (OfTheBatch, ".*after a picture without an object was added"),
    (EverywhereMeasured, ".*after the prediction outside the mask was changed"),
    (Alone, ".*when two processes each measured a part"),
]


@dataclass(frozen=True)
class Mirror(BatchAugmentation):
    """Mirrors every sample."""

    def __call__(self, batch: Batch, seed: int) -> Any:
        """Return a mirrored batch."""
        turn = torch.tensor([-1.0, 1, 1], device=batch["normal"].device).view(1, 3, 1, 1)
        mirrored: dict[str, Any] = {
            **batch,
            "sketch": batch["sketch"].flip(-1),
            "normal": batch["normal"].flip(-1) * turn,
            "mask": batch["mask"].flip(-1),
        }
        if "hints" in batch:
            hints = batch["hints"].flip(-1)
            mirrored["hints"] = torch.cat([hints[:, :3] * turn, hints[:, 3:]], dim=1)
        return mirrored


AUGMENTATIONS = broken(
    *(Mirror, "__call__", HERE),
    {
        "LosesHints": (
            lambda right, *given: {k: v for k, v in right(*given).items() if k != "hints"},
            "gave a batch without hints; an augmentation gives a batch with all that it was given",
        ),
        "LeavesVectors": (
            lambda right, batch, seed: {
                **batch,
                **{k: v.flip(-1) for k, v in batch.items() if isinstance(v, Tensor)},
            },
            r"left \d+% of the normals along the outline pointing inward",
        ),
        "LeavesHints": (
            lambda right, batch, seed: {**right(batch, seed), **{k: batch[k] for k in batch if k == "hints"}},
            r"left hints [\d.]+° from the normals where they lie",
        ),
    },
)


@dataclass(frozen=True)
class Horses(DataSource):
    """Six generated horses."""

    def split(self, settings: SplitSettings) -> Any:
        """Return them by split."""
        horses = {horse.name: horse for horse in make_animals(6, settings.data_seed, ["horse"])}
        return {part: [horses[name] for name in of] for part, of in settings.deal([*horses]).items()}


@dataclass(frozen=True)
class Text:
    """Something that loads as a text."""

    name: str

    def fingerprint(self) -> str:
        """Return what it is."""
        return self.name

    def load(self) -> Any:
        """Return no mesh."""
        return "text"


def texts(*names: str) -> Mapping[str, Sequence[Loadable]]:
    return {"train": [Text(name) for name in names]}


SOURCES = broken(
    *(Horses, "split", HERE),
    {
        "OfTexts": (
            lambda right, settings: texts("t0", "t1"),
            "has t0, which loads as str; load must return a Mesh",
        ),
        "Twice": (lambda right, settings: texts("t0", "t0"), "has two items named t0"),
    },
)


# Renderers and line styles


@dataclass(frozen=True)
class Rays(Renderer):
    """Embree's maps."""

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Any:
        maps = EmbreeRenderer().render(mesh, camera, size)
        return Maps(maps.normal.copy(), maps.depth.copy(), maps.mask.copy())


def painted(right: Any, *given: Any) -> Any:
    maps = right(*given)
    maps.normal[~maps.mask] = [0, 0, 1]
    return maps


def near(right: Any, *given: Any) -> Any:
    maps = right(*given)
    maps.depth[~maps.mask] = 0
    return maps


def flipped(right: Any, *given: Any) -> Any:
    maps = right(*given)
    return Maps(maps.normal[::-1].copy(), maps.depth[::-1].copy(), maps.mask[::-1].copy())


def from_the_near_plane(right: Any, mesh: Mesh, camera: Camera, size: int) -> Any:
    maps = right(mesh, camera, size)
    return replace(maps, depth=(maps.depth - camera.near).astype(np.float32))


def with_noise(right: Any, *given: Any) -> Any:
    maps = right(*given)
    noise = np.random.default_rng().normal(0, 1e-3, maps.depth.shape).astype(np.float32)
    return replace(maps, depth=maps.depth + noise)


def normals_times(factor: Any) -> Any:
    """Return a fault that multiplies the normals."""

    def wrong(right: Any, *given: Any) -> Any:
        maps = right(*given)
        return replace(maps, normal=maps.normal * factor)

    return wrong


def nearest_depth(right: Any, *given: Any) -> Any:
    maps = right(*given)
    _ = maps.depth[maps.mask].min()
    return maps


def of_the_world(right: Any, mesh: Mesh, camera: Camera, size: int) -> Any:
    maps = right(mesh, camera, size)
    return replace(maps, normal=(maps.normal @ camera.rotation).astype(np.float32))


def inside_out(right: Any, mesh: Mesh, camera: Camera, size: int) -> Any:
    maps = right(mesh, camera, size)
    return replace(maps, normal=-maps.normal) if mesh.name == "bowl" else maps


def no_opengl(right: Any) -> None:
    raise InputError("there is no OpenGL here.")


class Loose(Renderer):
    """Is no dataclass."""

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        return EmbreeRenderer().render(mesh, camera, size)


RENDERERS: Cases = [
    *broken(
        *(Rays, "render", HERE),
        {
            "NoMaps": (
                lambda right, *given: (right(*given).normal, right(*given).depth),
                "gave tuple; a renderer gives normalgan.rendering.Maps",
            ),
            "RendersDoubles": (
                normals_times(np.float64(1) * np.ones(3)),
                "gave a normal of float64; it must be float32",
            ),
            "Long": (
                normals_times(np.float32(2)),
                "rendered a normal with a length that is 1 off; normals on the object must be unit vectors",
            ),
            "Painted": (painted, "rendered normals outside the object; they must be zero there"),
            "Near": (near, "has a finite depth outside the object; it must be infinite there"),
            "Flipped": (
                flipped,
                r"has an IoU of \d+% with the true orthographic mask of an ellipsoid; the object must",
            ),
            "Green": (
                normals_times(np.array([1, -1, 1], np.float32)),
                r"is .*° off from the true orthographic normals of an ellipsoid; normals are in camera space",
            ),
            "OfTheWorld": (of_the_world, r"is .*° off from the true orthographic normals of an ellipsoid"),
            "FromTheNearPlane": (
                from_the_near_plane,
                "is .* off from the true orthographic depth of an ellipsoid; depth is the distance",
            ),
            "InsideOut": (
                inside_out,
                r"has 100% of the normals of an open shell facing away from the viewer; a surface seen from",
            ),
            "NeedsAnObject": (
                nearest_depth,
                "raised ValueError .* when asked for an empty view; a frame without the object",
            ),
            "NoisyMaps": (
                with_noise,
                "rendered the same view twice with different results; samples are cached by",
            ),
            "SeedsNumpy": (
                lambda right, *given: np.random.seed(0) or right(*given),  # noqa: NPY002
                "drew from or seeded numpy's global random state",
            ),
        },
    ),
    *broken(
        *(Rays, "check", HERE),
        {"Missing": (no_opengl, "raised InputError .there is no OpenGL here. when asked for running here")},
    ),
    (Loose, "Loose is not a frozen dataclass; its fields are its settings, which are part of the cache key"),
]


@dataclass(frozen=True)
class Outline(LineDrawing):
    """The silhouette, each of its strokes in full ink."""

    def trace(self, view: View, rng: np.random.Generator) -> Any:
        return [self.ink(s.points, s.width, rng) for s in Silhouette(resolution=96).trace(view, rng)]

    def ink(self, points: Any, width: Any, rng: np.random.Generator) -> Any:
        return Stroke(points, width, np.ones(len(points)))


def with_a_frame(right: Any, view: View, rng: np.random.Generator) -> Any:
    return [*right(view, rng), Stroke.even(np.array([[0.0, 0.5], [view.size, 0.5]]), 2.0)]


def never_nothing(right: Any, view: View, rng: np.random.Generator) -> Any:
    middle = np.full(2, view.size / 2)
    return right(view, rng) or [Stroke.even(np.stack([middle, middle + 1]), 2.0)]


def into_the_maps(right: Any, view: View, rng: np.random.Generator) -> Any:
    view.maps(2).depth[view.maps(2).mask] += 1
    return right(view, rng)


LINE_STYLES: Cases = [
    *broken(
        *(Outline, "ink", HERE),
        {
            "BarePoints": (
                lambda right, points, width, rng: points,
                "gave list of ndarray; a line style gives a list of Stroke",
            ),
            "Unplaced": (
                lambda right, points, width, rng: right(points * np.nan, width, rng),
                "gave a stroke whose points are not numbers; they must be finite",
            ),
            "Magnified": (
                lambda right, points, width, rng: right(points * 4, width, rng),
                r"gave a stroke from \d+\.\d+ to \d+\.\d+ pixels, up to .* wide, for a sketch of 96; points",
            ),
            "Thin": (
                lambda right, points, width, rng: right(points, 0 * width, rng),
                "traced a stroke of width 0 or less; a pen must be wider than 0",
            ),
            "Black": (
                lambda right, points, width, rng: Stroke(points, width, np.full(len(points), 255.0)),
                "traced a stroke of darkness .* to .*; darkness must be between 0",
            ),
        },
    ),
    *broken(
        *(Outline, "trace", HERE),
        {
            "Nothing": (
                lambda right, view, rng: [],
                "drew nothing of an animal; each object must give some ink",
            ),
            "Frame": (with_a_frame, r"put \d+% of its ink outside the animal; lines must lie on the object"),
            "NeverNothing": (never_nothing, "drew something in an empty view; it must draw nothing there"),
            "ExpectsAnObject": (
                lambda right, view, rng: (np.nonzero(view.maps().mask)[0].min(), right(view, rng))[1],
                "raised ValueError .* when asked for an empty view; an empty view must",
            ),
            "IntoTheMaps": (into_the_maps, "changed the maps of the view; all styles share them"),
        },
    ),
]

FAULTS: Cases = [
    *(*SAMPLERS, *SETTINGS, *GENERATORS, *DISCRIMINATORS, *OBJECTIVES, *RECONSTRUCTIONS),
    *(*METRICS, *AUGMENTATIONS, *SOURCES, *RENDERERS, *LINE_STYLES),
]


@pytest.mark.parametrize(("cls", "sentence"), FAULTS, ids=[cls.__name__ for cls, _ in FAULTS])
def test_a_fault_is_told_in_one_sentence(cls: type[Any], sentence: str) -> None:
    with pytest.raises(ConformanceError, match=f"^{sentence}") as caught:
        check(cls())
    said = str(caught.value)
    assert "\n" not in said
    assert said.endswith(".")
    assert len(said) < 400


@pytest.mark.parametrize(
    "cls", [Sampler, Network, Judge, Spectral, Plain, Squares, Worst, Mirror, Horses, Rays, Outline]
)
def test_one_without_a_fault_passes(cls: type[Any]) -> None:
    check(cls())


def test_pairs_on_disk_pass(tmp_path: Path) -> None:
    check(Pairs(str(write_pairs(tmp_path, 6))))


def test_what_is_no_plugin_is_told() -> None:
    given: Any = Sampler
    with pytest.raises(ConformanceError, match=r"^Sampler is a class; give an object of it, Sampler\(…\)\.$"):
        check(given)
    with pytest.raises(ConformanceError, match=r"^int is not a kind of plug-in; .* one of .*, HintSampler, "):
        check(3)


def test_a_class_inside_a_function_is_told_off() -> None:
    class Inner(Sampler):
        """Cannot be named."""

    with pytest.raises(
        ConformanceError, match=r"Inner cannot be imported as .*<locals>\.Inner; YAML and check"
    ):
        check(Inner())


@pytest.mark.parametrize("kind", [HintSampler, LineDrawing, BatchAugmentation])
def test_the_seed_of_every_kind_that_draws_is_checked(kind: type) -> None:
    assert {"the same output for the same seed", "no use of global randomness"} <= {
        each.name for each in checks(kind)
    }


def test_checks_are_assertions_with_names_of_their_own() -> None:
    names = [str(each) for each in checks(HintSampler)]
    assert len(set(names)) == len(names) > 10
    assert "hints on the object" in names
    assert issubclass(ConformanceError, AssertionError)
