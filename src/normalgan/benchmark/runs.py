"""Runs: resolve the settings of each row and seed of a plan before training."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from normalgan.benchmark.plan import Plan, Row, Settings, read_yaml
from normalgan.benchmark.scale import Scale
from normalgan.benchmark.settings import MACHINE, compose, differences, digest, nest, part, without
from normalgan.cli.parsing.light_parser import OwnDefaultsParser
from normalgan.data.datamodule import MeshDataModule
from normalgan.errors import InputError

_OWN_DATA = (
    *("data.animals.extra", "data.animals.extra_postures", "data.augmentation", "data.batch_size"),
    *("data.on_the_fly", "data.prediction", "data.reading.variants", "data.reading.variation"),
    *("data.storage", "data.workers"),
)
"""Data settings that may differ between rows; all others must be the same."""

_LENGTHS = ("T_max", "total_steps")
"""Settings of schedules that end with the run: of a cosine, and of one cycle."""


@dataclass(frozen=True)
class Run:
    """A row of the plan with one seed.

    Args:
        row: row of the plan.
        seed: seed of initialisation, training hints and dropout; None without training.
        folder: folder of the run.
        settings: all settings of `normalgan fit`; without training, only the data settings are used.
    """

    row: Row
    seed: int | None
    folder: Path
    settings: Settings

    @property
    def title(self) -> str:
        """The name of the run in messages."""
        return self.row.name if self.seed is None else f"{self.row.name}, seed {self.seed}"

    @cached_property
    def identity(self) -> Settings:
        """Everything that training depends on; equal identities give equal models on the same machine."""
        settings = without(self.settings, MACHINE)
        if self.row.classical:
            settings = {"data": settings["data"], "classical": self.row.classical}
        data = build_data(self.settings)
        meshes = {split: [source.name for source in found] for split, found in data.sources.items()}
        return {**settings, "meshes": meshes}

    @cached_property
    def hash(self) -> str:
        """A short hash of the identity."""
        return digest(self.identity)


def build_data(settings: Settings, **changes: Any) -> MeshDataModule:
    """Return the data module of a run's settings, with some data settings changed."""
    parser = OwnDefaultsParser(exit_on_error=False)
    parser.add_class_arguments(MeshDataModule, "data")
    parsed = parser.parse_object({"data": changes}, parser.parse_object({"data": settings["data"]}))
    data: MeshDataModule = parser.instantiate(parsed).data
    return data


def shared_settings(plan: Plan, scale: Scale) -> Settings:
    """Return the settings of the data that all rows share and of the device for measuring.

    Raises:
        InputError: if a setting is invalid.
    """
    overlays = [part(overlay, ["data", "trainer"]) for overlay in scale.overlays]
    layers = [{"data": nest(plan.data)}, *overlays, scale.given or {}]
    if plan.test_data:
        try:
            compose([*layers, {"data": plan.test_data}])  # refuses invalid settings before training
        except InputError as error:
            raise InputError(f"test_data of the plan cannot be used: {error}") from error
    return compose(layers)


def _row_settings(plan: Plan, row: Row, scale: Scale) -> Settings:
    """Return all settings of a trained row, except for the seed and the duration.

    Raises:
        InputError: if a setting is invalid; the message names the row.
    """
    layers = [read_yaml(path) for path in row.configs]
    layers += [nest(row.changes), {"data": nest(plan.data)}]
    layers += [part(overlay, row.takes) for overlay in scale.overlays]
    try:
        return compose([*layers, nest(row.settings), scale.given or {}])
    except InputError as error:
        raise InputError(f"the row {row.name} cannot be composed: {error}") from error


def check_shared(row: Row, settings: Settings, shared: Settings) -> None:
    """Check that a row uses the data that all rows share.

    Raises:
        InputError: if its data settings differ.
    """
    differing = differences(*(without({"data": each["data"]}, _OWN_DATA) for each in (settings, shared)))
    if differing:
        names = ", ".join(differing[:4])
        overlay = "" if row.takes is None else ", or name it in takes, if an overlay sets it for the others"
        raise InputError(
            f"the row {row.name} sets {names}, which all rows of a comparison share; set it in the plan's "
            f"data{overlay}."
        )


def timed(settings: Settings, images: int, samples: int, seconds: float | None) -> Settings:
    """Return settings that train the generator on a number of images or for a wall-clock time.

    The duration is rounded to whole epochs; with ``n_critic`` n, the generator steps every n batches. A
    cosine schedule ends with the run. With a time budget, the schedule follows the clock.

    Args:
        settings: settings of a row.
        images: number of images; batches that only train the discriminator are not counted.
        samples: number of samples in the training split.
        seconds: wall-clock budget; None trains on the number of images.
    """
    model, trainer, batch = settings["model"], dict(settings["trainer"]), settings["data"]["batch_size"]
    callbacks = [*(trainer["callbacks"] or []), {"class_path": "normalgan.callbacks.LearningCurve"}]
    schedule = model["lr_scheduler"]
    if seconds is not None:
        trainer["max_epochs"], schedule = -1, None
        clock = {"class_path": "normalgan.callbacks.WallClockSchedule", "init_args": {"seconds": seconds}}
        callbacks.append(clock)
    else:
        whole = samples // batch * batch if samples >= batch else samples  # without an incomplete last batch
        trainer["max_epochs"] = max(1, round(images * _batches_a_step(settings) / whole))
        if schedule is not None:
            given = schedule.get("init_args", {})
            ends = {name: trainer["max_epochs"] for name in _LENGTHS if name in given}
            schedule = {**schedule, "init_args": {**given, **ends}} if ends else schedule
    trainer |= {"callbacks": callbacks, "max_steps": -1, "max_time": None, "check_val_every_n_epoch": 1}
    return {**settings, "trainer": trainer, "model": {**model, "lr_scheduler": schedule}}


def plan_runs(plan: Plan, scale: Scale, out: Path, seeds: Sequence[int]) -> list[Run]:
    """Return all runs of a plan: rows without training first, then seed by seed.

    Raises:
        InputError: if a row is invalid, or its data differ from the other rows'.
    """
    shared = shared_settings(plan, scale)
    runs = [Run(row, None, out / row.name, shared) for row in plan.rows if row.classical]
    settings: dict[str, Settings] = {}
    for row in plan.rows:
        if not row.classical:
            composed = _row_settings(plan, row, scale)
            check_shared(row, composed, shared)
            data = build_data(composed)
            samples = len(data.sources["train"]) * data.views_per_mesh["train"]
            settings[row.name] = timed(composed, plan.images, samples, scale.seconds)
    for seed in seeds:
        for row in plan.rows:
            if not row.classical:
                folder = out / row.name / f"seed{seed}"
                seeded = _seeded(settings[row.name], seed, folder)
                runs.append(Run(row, seed, folder, seeded))
    return runs


def _seeded(settings: Settings, seed: int, folder: Path) -> Settings:
    trainer = {**settings["trainer"], "default_root_dir": str(folder), "enable_progress_bar": False}
    model = {**settings["model"], "seed": seed}
    return {**settings, "seed_everything": seed, "trainer": trainer, "model": model}


def _batches_a_step(settings: Settings) -> int:
    return int(settings["model"]["n_critic"]) if settings["model"]["discriminator"] is not None else 1
