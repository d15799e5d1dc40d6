"""Mixed precision without a GPU: what CUDA autocast bans raises here; what bfloat16 rounds is measured."""

from collections.abc import Callable
from itertools import product
from typing import Any

import pytest
import torch
from torch import Tensor, nn
from torch.utils._python_dispatch import TorchDispatchMode

from normalgan.losses import (
    ADVERSARIAL_OBJECTIVES,
    RECONSTRUCTIONS,
    AdversarialObjective,
    AngularLikelihood,
    CosineAndL2,
    CrossEntropy,
    L1AndHints,
    Reconstruction,
    Wasserstein,
    WassersteinGradientPenalty,
)
from normalgan.models import (
    Discriminator,
    Generator,
    GlobalDiscriminator,
    PatchDiscriminator,
    ResidualUNetGenerator,
    TiledGenerator,
    UNetDiscriminator,
    UNetGenerator,
)
from normalgan.models.condition import make_condition, paste_hints
from spheres import batch

torch.set_num_threads(1)

BANNED = {"binary_cross_entropy", "binary_cross_entropy_backward"}
"""What raises under CUDA's autocast whatever the type of its input (see aten/src/ATen/autocast_mode.h)."""

GENERATORS: dict[str, Callable[[], Generator]] = {
    "unet": lambda: UNetGenerator(size=32, width=4),
    "residual": lambda: ResidualUNetGenerator((8, 8), (1, 1)),
    "residual, batch norm": lambda: ResidualUNetGenerator((8, 8), (1, 1), norm="batch"),
    "tiled": lambda: TiledGenerator(window=16, widths=(8, 8), blocks=(1, 1)),
}
DISCRIMINATORS: dict[str, Callable[[], Discriminator]] = {
    "unet": lambda: UNetDiscriminator(size=32, width=4, norm="instance"),
    "patch": lambda: PatchDiscriminator(width=4, layers=2, norm="instance"),
    "global": lambda: GlobalDiscriminator(size=32, width=4, norm="instance"),
}
RECONSTRUCTION_LOSSES: dict[type[Reconstruction], list[Reconstruction]] = {
    L1AndHints: [L1AndHints()],
    AngularLikelihood: [AngularLikelihood(), AngularLikelihood(angle_weight=3.0)],
    CosineAndL2: [CosineAndL2()],
}
OBJECTIVES: dict[type[AdversarialObjective], AdversarialObjective] = {
    kind: kind() for kind in (CrossEntropy, Wasserstein, WassersteinGradientPenalty)
}


class CudaAutocastRules(TorchDispatchMode):
    """Raises at operations that CUDA's autocast refuses."""

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        if func.overloadpacket.__name__ in BANNED:
            raise RuntimeError(f"{func} is unsafe to autocast")
        return func(*args, **(kwargs or {}))


def condition_and_hints() -> tuple[Tensor, Tensor]:
    given = batch()
    where = torch.zeros_like(given["mask"])
    where[..., 12:20, 12:20] = given["mask"][..., 12:20, 12:20]
    hints = torch.cat([given["normal"] * where, where], dim=1)
    return make_condition(given["sketch"], hints), hints


def test_the_rules_are_those_of_cuda() -> None:
    half = torch.full((2,), 0.5)
    with CudaAutocastRules(), pytest.raises(RuntimeError, match="unsafe"):  # type: ignore[no-untyped-call]
        nn.functional.binary_cross_entropy(half, half)


def test_every_loss_is_tried_here() -> None:
    """A new one has to be added above."""
    ours = {kind.__name__ for kind in [*RECONSTRUCTION_LOSSES, *OBJECTIVES]}
    assert {*RECONSTRUCTIONS.names(), *ADVERSARIAL_OBJECTIVES.names()} <= ours


@pytest.mark.parametrize(
    ("name", "loss"),
    [
        (name, loss)
        for name in GENERATORS
        for few in RECONSTRUCTION_LOSSES.values()
        for loss in few
        if name not in {"unet", "tiled"}
        or not isinstance(loss, AngularLikelihood)  # which needs a confidence
    ],
    ids=str,
)
def test_generators_and_reconstructions_train_in_bfloat16(name: str, loss: Reconstruction) -> None:
    torch.manual_seed(0)
    generator, given, (condition, hints) = GENERATORS[name](), batch(), condition_and_hints()
    with CudaAutocastRules():  # type: ignore[no-untyped-call]
        with torch.autocast("cpu", torch.bfloat16):
            preds = generator.predict(condition)
            assert {part.dtype for part in preds if part is not None} == {torch.float32}
            terms = loss.terms(preds, given["normal"], given["mask"], hints[:, 3:])
        assert {term.value.dtype for term in terms.values()} == {torch.float32}
        torch.stack([term.weight * term.value for term in terms.values()]).sum().backward()
    grads = [p.grad for p in generator.parameters()]
    assert all(grad is not None and grad.isfinite().all() for grad in grads)
    assert any(grad.any() for grad in grads if grad is not None)


@pytest.mark.parametrize(("name", "kind"), list(product(DISCRIMINATORS, OBJECTIVES)))
def test_discriminators_and_objectives_train_in_bfloat16(name: str, kind: type[AdversarialObjective]) -> None:
    torch.manual_seed(0)
    discriminator, objective, given = DISCRIMINATORS[name](), OBJECTIVES[kind], batch()
    (condition, hints), fake = condition_and_hints(), 0.3 * torch.randn(2, 3, 32, 32)
    fake = paste_hints(fake, hints)
    with CudaAutocastRules():  # type: ignore[no-untyped-call]
        with torch.autocast("cpu", torch.bfloat16):
            real_scores, fake_scores = (
                discriminator(condition, given["normal"]),
                discriminator(condition, fake),
            )
            losses = [
                objective.discriminator_loss(real_scores, fake_scores),
                objective.generator_loss(fake_scores),
                objective.penalty(lambda normal: discriminator(condition, normal), given["normal"], fake),
            ]
        assert {loss.dtype for loss in losses} == {torch.float32}
        torch.stack(losses).sum().backward()
    grads = [p.grad for p in discriminator.parameters()]
    assert all(grad is None or grad.isfinite().all() for grad in grads)
    assert any(grad.any() for grad in grads if grad is not None)


@pytest.mark.parametrize("surely", [8.0, -8.0])
def test_a_presence_that_is_sure_and_wrong_still_learns(surely: float) -> None:
    """As a probability in bfloat16 it would be 1, or be clamped, and stay wrong for good."""
    torch.manual_seed(0)
    generator, given, (condition, hints) = (
        ResidualUNetGenerator((8, 8), (1, 1)),
        batch(),
        condition_and_hints(),
    )
    last = generator.detail[2]
    assert isinstance(last, nn.Conv2d)
    assert last.bias is not None
    with torch.no_grad():
        last.bias[3] = surely
    with torch.autocast("cpu", torch.bfloat16):
        preds = generator.predict(condition)
        terms = AngularLikelihood().terms(preds, given["normal"], given["mask"], hints[:, 3:])
    terms["presence"].value.backward()
    assert last.bias.grad is not None
    wrong = 1 - given["mask"].mean() if surely > 0 else -given["mask"].mean()
    assert float(last.bias.grad[3]) == pytest.approx(float(wrong), rel=0.05)


def test_bfloat16_turns_normals_little() -> None:
    """What the heads say is not rounded to 8 bits."""
    torch.manual_seed(0)
    generator, (condition, _) = ResidualUNetGenerator((8, 8), (1, 1)).eval(), condition_and_hints()
    with torch.no_grad():
        exact = generator.predict(condition)
        with torch.autocast("cpu", torch.bfloat16):
            mixed = generator.predict(condition)
    for part in mixed:
        assert part is not None
        assert not torch.equal(part, part.bfloat16().float())
    turned = torch.rad2deg(
        torch.atan2(torch.linalg.cross(exact[0], mixed[0], dim=1).norm(dim=1), (exact[0] * mixed[0]).sum(1))
    )
    assert float(turned.mean()) < 2
