"""What `fit` takes beside a bare PyTorch loop of the same networks, batches and optimisers.

    python benchmarks/overhead.py --size 64 --blocks 12 -o overhead.json

Both take turns in one process, a few steps each, so that what else the machine does slows both: the
ratios of the pairs count, by the clock and by the time that the process had a core. `fit` loads, augments,
draws hints, checks its losses and logs; the bare loop is given one batch on the device and does the
arithmetic alone.
"""

import json
import statistics
import tempfile
import time
from argparse import ArgumentParser
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
import torch.nn.functional as F
from lightning.pytorch import Callback, LightningModule, Trainer
from lightning.pytorch.loggers import TensorBoardLogger
from machine import describe
from torch import Tensor

from normalgan.batch import Batch
from normalgan.data.augmentation import Augmentation
from normalgan.data.datamodule import MeshDataModule
from normalgan.gan import NormalGAN
from normalgan.hints import NoHints
from normalgan.losses import CrossEntropy, L1AndHints
from normalgan.models import PatchDiscriminator, UNetGenerator
from normalgan.models.condition import make_condition
from normalgan.rendering import EmbreeRenderer

L1 = 100.0


def adam(parameters: Any) -> torch.optim.Adam:
    """Return pix2pix's optimiser."""
    return torch.optim.Adam(parameters, lr=2e-4, betas=(0.5, 0.999))


def networks(size: int) -> tuple[UNetGenerator, PatchDiscriminator]:
    """Return pix2pix's networks, slim enough for a processor."""
    return UNetGenerator(size, width=24, norm="instance"), PatchDiscriminator(width=8, norm="instance")


def bare_loop(size: int, device: torch.device) -> Callable[[Batch], None]:
    """Return a training step written down as briefly as can be."""
    generator, discriminator = (network.to(device).train() for network in networks(size))
    optimisers = adam(generator.parameters()), adam(discriminator.parameters())

    def cross_entropy(score: Tensor, target: float) -> Tensor:
        return F.binary_cross_entropy_with_logits(score, torch.full_like(score, target))

    def step(batch: Batch) -> None:
        normal = batch["normal"]
        condition = make_condition(batch["sketch"], torch.zeros_like(torch.cat([normal, batch["mask"]], 1)))
        fake = generator(condition)
        (real_score,) = discriminator(condition, normal)
        (fake_score,) = discriminator(condition, fake.detach())
        optimisers[1].zero_grad()
        ((cross_entropy(real_score, 1.0) + cross_entropy(fake_score, 0.0)) / 2).backward()
        optimisers[1].step()
        for parameter in discriminator.parameters():
            parameter.requires_grad_(False)
        (score,) = discriminator(condition, fake)
        optimisers[0].zero_grad()
        (cross_entropy(score, 1.0) + L1 * (fake - normal).abs().mean()).backward()
        optimisers[0].step()
        for parameter in discriminator.parameters():
            parameter.requires_grad_(True)

    return step


@dataclass(frozen=True)
class Clocks:
    """Seconds by the clock, and those in which this process had a core."""

    wall: float
    process: float

    def __sub__(self, other: "Clocks") -> "Clocks":
        return Clocks(self.wall - other.wall, self.process - other.process)

    def __truediv__(self, steps: int) -> "Clocks":
        return Clocks(self.wall / steps, self.process / steps)


class TakingTurns(Callback):
    """Times blocks of batches of `fit`, and after each as many steps of the bare loop.

    Args:
        steps: of a block.
        size: side of the pictures.
        augmentation: timed alone too.
    """

    def __init__(self, steps: int, size: int, augmentation: Augmentation) -> None:
        self.steps = steps
        self.size = size
        self.augmentation = augmentation
        self.times: dict[str, list[Clocks]] = {"fit": [], "bare": [], "augmentation": []}
        self._bare: Callable[[Batch], None] | None = None
        self._since = Clocks(0.0, 0.0)

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: Any, batch: Batch, batch_idx: int
    ) -> None:
        """Take a turn after each block."""
        if (trainer.fit_loop.total_batch_idx + 1) % self.steps:
            return
        now = self._clock(pl_module.device)
        if self._bare is None:  # the first block warms up
            self._bare = bare_loop(self.size, pl_module.device)
            self._bare(batch)
        else:
            self.times["fit"].append((now - self._since) / self.steps)
            for name, function in (("bare", self._bare), ("augmentation", lambda b: self.augmentation(b, 0))):
                start = self._clock(pl_module.device)
                for _ in range(self.steps):
                    function(batch)
                self.times[name].append((self._clock(pl_module.device) - start) / self.steps)
        self._since = self._clock(pl_module.device)

    @staticmethod
    def _clock(device: torch.device) -> "Clocks":
        if device.type == "cuda":
            torch.cuda.synchronize(device)
        return Clocks(time.perf_counter(), time.process_time())


def measure(size: int, batch_size: int, steps: int, blocks: int, folder: Path) -> dict[str, Any]:
    """Return milliseconds a step of each, and how fast `fit` is beside the bare loop."""
    augmentation = Augmentation(rotation=10.0, jitter=0.7, dropout=0.05, width=0.4)
    data = MeshDataModule(
        animals=4,
        size=size,
        fractions=(0.5, 0.25, 0.25),
        train_views=batch_size * 32,  # epochs of 64 batches, as of a few meshes
        val_views=1,
        test_views=1,
        renderer=EmbreeRenderer(),
        batch_size=batch_size,
        augmentation=augmentation,
        cache=str(folder / "cache"),
    )
    generator, discriminator = networks(size)
    gan = NormalGAN(
        generator,
        discriminator,
        NoHints(),
        CrossEntropy(),
        generator_optimizer=adam,
        discriminator_optimizer=adam,
        reconstruction=L1AndHints(L1, 0.0),
        n_critic=1,
    )
    turns = TakingTurns(steps, size, augmentation)
    trainer = Trainer(
        max_steps=2 * steps * (blocks + 1),  # of both optimisers
        max_epochs=-1,
        limit_val_batches=0,
        callbacks=[turns],
        logger=TensorBoardLogger(folder, name=""),
        log_every_n_steps=50,
        enable_checkpointing=False,
        enable_model_summary=False,
    )
    trainer.fit(gan, data)
    return {
        "size": size,
        "batch_size": batch_size,
        "pairs": len(turns.times["fit"]),
        "device": str(gan.device),
        **{clock: summary(turns.times, clock, batch_size) for clock in ("wall", "process")},
    }


def summary(times: dict[str, list[Clocks]], clock: str, batch_size: int) -> dict[str, Any]:
    """Return medians by one clock, and how fast `fit` is beside the bare loop."""
    by_name = {name: [getattr(each, clock) for each in of] for name, of in times.items()}
    ratios = [bare / fit for bare, fit in zip(by_name["bare"], by_name["fit"], strict=True)]
    return {
        "milliseconds": {name: round(1e3 * statistics.median(of), 2) for name, of in by_name.items()},
        "images_per_second": {
            name: round(batch_size / statistics.median(by_name[name]), 1) for name in ("fit", "bare")
        },
        "ratio": {
            "median": round(statistics.median(ratios), 3),
            "least": round(min(ratios), 3),
            "most": round(max(ratios), 3),
        },
    }


def main() -> None:
    """Measure and write it down."""
    parser = ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("--size", type=int, default=64)
    parser.add_argument("--batch_size", type=int, default=8)
    parser.add_argument("--steps", type=int, default=10, help="of a block")
    parser.add_argument("--blocks", type=int, default=12)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    with tempfile.TemporaryDirectory() as folder:
        found = measure(options.size, options.batch_size, options.steps, options.blocks, Path(folder))
    report = {**found, "machine": describe("torch", "lightning"), "threads": options.threads}
    text = json.dumps(report, indent=1)
    print(text)
    if options.output:
        options.output.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
