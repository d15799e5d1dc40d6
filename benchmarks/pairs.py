"""Measures how soon training on pairs of pictures begins, with a cache that is empty, then with the same one.

benchmarks/pairs.py [--pairs 10000] [--size 128] [--workers 0]

The pairs are written first, outside the time that is measured. The network is tiny; what is measured is the
time from `Trainer.fit` to the end of the first training step.
"""

import argparse
import os
import resource
import shutil
import sys
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any

from machine import ONE_THREAD

os.environ.update(ONE_THREAD)  # before numpy and its friends are imported, here and in every child
sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from lightning.pytorch import Callback, Trainer

from normalgan.data.datamodule import MeshDataModule
from normalgan.data.sources import Pairs
from pairs_on_disk import write_pair
from small import gan

DIFFERENT = 50


class FirstStep(Callback):
    """Notes when the first training step has ended."""

    def on_train_batch_end(self, *_: Any) -> None:
        """Note the time."""
        self.wall, self.cpu = time.perf_counter(), processor_time()


def processor_time() -> float:
    """Return the seconds of processor time that this process and its ended children have taken."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def write(folder: Path, count: int, size: int) -> None:
    """Write pairs, of which some show the same."""
    folder.mkdir()
    for number in range(count):
        names = [f"p{number:05}{ending}.png" for ending in ("", "_normal")]
        if number < DIFFERENT:
            write_pair(*(folder / name for name in names), number, size=size)
        else:
            for name in names:
                shutil.copyfile(
                    folder / name.replace(f"{number:05}", f"{number % DIFFERENT:05}"), folder / name
                )


def first_step(folder: Path, size: int, workers: int) -> tuple[float, float]:
    """Return the seconds until the first step has ended, and those of processor time."""
    data = MeshDataModule(
        source=Pairs(str(folder / "pairs")), cache=str(folder / "cache"), size=size, workers=workers
    )
    first = FirstStep()
    trainer = Trainer(
        accelerator="cpu",
        callbacks=[first],
        default_root_dir=folder,
        enable_checkpointing=False,
        enable_model_summary=False,
        enable_progress_bar=False,
        limit_train_batches=1,
        limit_val_batches=1,
        logger=False,
        max_epochs=1,
    )
    wall, cpu = time.perf_counter(), processor_time()
    trainer.fit(gan(), data)
    return first.wall - wall, first.cpu - cpu


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--pairs", type=int, default=10_000)
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--workers", type=int, default=0)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as made:
        write(Path(made) / "pairs", given.pairs, given.size)
        for cache in ("an empty cache", "the same cache"):
            wall, cpu = first_step(Path(made), given.size, given.workers)
            print(
                f"{given.pairs} pairs, {cache}: first step after {wall:.1f} s, {cpu:.1f} s of processor time"
            )


if __name__ == "__main__":
    main()
