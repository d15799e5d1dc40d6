"""Trains on exact lines and on the hand's, tests each model on both, and stores the results run by run."""

import json
import time
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from lightning.pytorch import Trainer, seed_everything
from machine import describe

from normalgan.commit import commit
from normalgan.data.augmentation import Augmentation
from normalgan.data.datamodule import MeshDataModule
from normalgan.data.settings import EmbeddedAnimals
from normalgan.files.json_files import encode_json
from normalgan.files.writing import write_bytes
from normalgan.gan import NormalGAN
from normalgan.hints import NoHints
from normalgan.losses import Wasserstein
from normalgan.models import UNetDiscriminator, UNetGenerator
from normalgan.rendering.hand import Hand
from normalgan.rendering.lines import SuggestiveContours

TRAINED: dict[str, Hand | None] = {"exact": None, "hand": Hand()}
TESTED: dict[str, Hand | None] = {"exact": None, "hand": Hand(strength=(1.0, 1.0))}
METRIC = "angular_mean"
_NO_HINTS = "test/no_hints/"


@dataclass(frozen=True)
class Settings:
    """The scale of the experiment, which all runs in a results file share.

    Args:
        epochs: epochs of each training.
        animals: number of embedded animals, split by animal.
        train_views: views of each training animal.
        test_views: views of each test animal.
        size: side of the pictures in pixels.
        batch_size: samples in a batch.
    """

    epochs: int
    animals: int
    train_views: int
    test_views: int
    size: int = 64
    batch_size: int = 16


def data(settings: Settings, hand: Hand | None, train_views: int, cache: str) -> MeshDataModule:
    """Return a data module with the same animals and views for every way of drawing."""
    return MeshDataModule(
        animals=EmbeddedAnimals(settings.animals),
        size=settings.size,
        train_views=train_views,
        val_views=1,
        test_views=settings.test_views,
        hand=hand,
        lines=SuggestiveContours(resolution=256),  # as in configs/quickstart.yaml
        cache=cache,
        batch_size=settings.batch_size,
        # Whole samples are shifted, but lines are not roughened: the hand is compared with exactly that.
        augmentation=Augmentation(jitter=0, dropout=0, width=0),
        seed=0,
    )


def model(settings: Settings, seed: int) -> NormalGAN:
    """Return the networks of configs/quickstart.yaml, without hints."""
    return NormalGAN(
        generator=UNetGenerator(size=settings.size, width=24),
        discriminator=UNetDiscriminator(size=settings.size, width=8),
        hint_sampler=NoHints(),
        objective=Wasserstein(),
        generator_optimizer=partial(torch.optim.RMSprop, lr=1e-3, alpha=0.9),
        discriminator_optimizer=partial(torch.optim.RMSprop, lr=1e-4, alpha=0.9),
        lr_scheduler=partial(torch.optim.lr_scheduler.CosineAnnealingLR, T_max=settings.epochs),
        n_critic=1,
        seed=seed,
    )


def run(settings: Settings, trained_on: str, seed: int, cache: str) -> dict[str, Any]:
    """Train one model, test it on both kinds of lines, and return the results."""
    start = time.perf_counter()
    seed_everything(seed, verbose=False)
    network = model(settings, seed)
    quiet: dict[str, Any] = {
        "accelerator": "cpu",
        "logger": False,
        "enable_checkpointing": False,
        "enable_progress_bar": False,
        "enable_model_summary": False,
    }
    trainer = Trainer(max_epochs=settings.epochs, limit_val_batches=0, num_sanity_val_steps=0, **quiet)
    trainer.fit(network, datamodule=data(settings, TRAINED[trained_on], settings.train_views, cache))
    tested = {}
    for name, hand in TESTED.items():
        (found,) = Trainer(**quiet).test(network, datamodule=data(settings, hand, 1, cache), verbose=False)
        tested[name] = {
            key.removeprefix(_NO_HINTS): value for key, value in found.items() if key.startswith(_NO_HINTS)
        }
    return {
        "seed": seed,
        "trained_on": trained_on,
        "tested_on": tested,
        "seconds": round(time.perf_counter() - start, 1),
    }


def run_all(settings: Settings, seeds: list[int], output: Path, cache: str) -> str:
    """Run what the results file lacks, save it after each run, and return the table of all its runs."""
    scale = {**asdict(settings), "hand": asdict(Hand())}
    results: dict[str, Any] = {"settings": scale, "commit": "", "machine": describe("torch"), "runs": []}
    if output.exists():
        results = json.loads(output.read_text(encoding="utf-8"))
        if results["settings"] != json.loads(json.dumps(scale)):
            raise SystemExit(f"{output} holds runs of another scale. Choose another --output, or delete it.")
    done = {(one["seed"], one["trained_on"]) for one in results["runs"]}
    for seed in seeds:
        for trained_on in TRAINED:
            if (seed, trained_on) in done:
                continue
            results["runs"].append(run(settings, trained_on, seed, cache))
            results["commit"] = commit()
            write_bytes(output, encode_json(results))
            print(f"seed {seed}, trained on {trained_on}: {results['runs'][-1]['seconds']} s", flush=True)
    return table(results["runs"])


def table(runs: list[dict[str, Any]]) -> str:
    """Return the mean angular errors as a Markdown table: mean ± standard deviation over the seeds."""
    lines = [
        f"| trained on | {' | '.join(f'tested on {name}' for name in TESTED)} | loss |",
        "| --- |" + " --- |" * 3,
    ]
    for trained_on in TRAINED:
        own = [one["tested_on"] for one in runs if one["trained_on"] == trained_on]
        errors = np.array([[one[name][METRIC] for name in TESTED] for one in own])
        if not len(errors):
            continue
        columns = [*errors.T, errors[:, 1] - errors[:, 0]]
        cells = [f"{c.mean():.2f}° ± {c.std(ddof=1) if len(c) > 1 else float('nan'):.2f}" for c in columns]
        lines.append(f"| {trained_on} | {' | '.join(cells)} |")
    return "\n".join(lines)
