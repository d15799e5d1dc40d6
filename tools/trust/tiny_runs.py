"""Tiny runs: training of a few seconds, and what must be true of their checkpoints."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from diary import epochs_before
from moments import Moment
from nursery import Child, rear
from test_resume import assert_same

from five_meshes import write_meshes
from normalgan.weights.checkpoint import read_checkpoint

CONF = Path(__file__).parents[2] / "tests" / "conf"
COMPARED = ("state_dict", "optimizer_states", "lr_schedulers", "global_step", "epoch")


@dataclass(frozen=True)
class TinyRun:
    """Training of four epochs at 32 pixels, in a folder of its own.

    Args:
        work: folder that such runs share: meshes, samples, logs.
        name: of this one.
        seed: of all that it draws.
    """

    work: Path
    name: str
    seed: int = 0

    @property
    def folder(self) -> Path:
        """Where it writes."""
        return self.work / self.name

    @property
    def checkpoints(self) -> dict[str, Path]:
        """What is saved, by name."""
        return {path.name: path for path in sorted((self.folder / "checkpoints").glob("*.ckpt"))}

    @property
    def diary(self) -> Path:
        """Where the epochs are noted that began."""
        return self.work / f"{self.name}.diary"

    def train(self, moment: Moment | None = None, fresh: bool = False) -> Child:
        """Train, from the last checkpoint on if there is one."""
        meshes = self.work / "meshes"
        if not meshes.exists():
            meshes.mkdir(parents=True)
            write_meshes(meshes)
        resume = ["--ckpt_path", "last"] if "last.ckpt" in self.checkpoints else []
        arguments = (
            *("fit", "--config", CONF / "tiny.yaml", "--config", CONF / "resume.yaml"),
            *("--data.meshes", meshes, "--data.cache", self.work / "cache"),
            *("--trainer.default_root_dir", self.folder, "--seed_everything", self.seed),
            *("--model.seed", self.seed, "--data.seed", self.seed),
            *("--trainer.callbacks", "diary.Diary", "--trainer.callbacks.path", self.diary),
        )
        log = self.work / f"{self.name}.log"
        return rear([*map(str, arguments), *resume], self.folder, log, moment, fresh)

    @property
    def kept(self) -> int:
        """Whole epochs in the last checkpoint."""
        last = self.checkpoints.get("last.ckpt")
        return int(load(last)["epoch"]) + 1 if last else 0

    def troubles(self) -> list[str]:
        """Return what is wrong after a kill: checkpoints that do not load, or more lost than an epoch."""
        found = []
        for name, path in self.checkpoints.items():
            try:
                read_checkpoint(path)
                load(path)
            except Exception as error:
                found.append(f"{name} does not load: {error!r}")
        if not found and self.kept < (done := epochs_before(self.diary)):
            found.append(f"{done} epochs were done, and {self.kept} are kept")
        return found

    def differences(self, other: "TinyRun") -> list[str]:
        """Return what is not as in another run: the files by name, and in them all that was learnt."""
        names = [sorted(_left_in(run.folder)) for run in (self, other)]
        if names[0] != names[1]:
            return [f"it left {names[0]}, not {names[1]}"]
        found = []
        for name, path in self.checkpoints.items():
            mine, theirs = load(path), load(other.checkpoints[name])
            for part in COMPARED:
                try:
                    assert_same(mine[part], theirs[part], part)
                except AssertionError as error:
                    found.append(f"{name} differs in {error}")
        return found


def load(path: Path) -> dict[str, Any]:
    """Return what is in a checkpoint."""
    checkpoint: dict[str, Any] = torch.load(path, weights_only=True)
    return checkpoint


def _left_in(folder: Path) -> list[str]:
    """Return the files of a run but for TensorBoard's, of which each start leaves one."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return [str(path.relative_to(folder)) for path in files if "tfevents" not in path.name]
