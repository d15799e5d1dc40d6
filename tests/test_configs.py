import contextlib
import importlib
import inspect
import itertools
import json
import re
from collections.abc import Iterator, Mapping
from functools import cache as remember
from pathlib import Path
from typing import Any

import pytest
import torch
import yaml
from torch import nn

from normalgan.cli.training import command as cli
from normalgan.losses import AdversarialObjective

Settings = dict[str, Any]

ROOT = Path(__file__).parents[1]
METHODS = ("paper", "sketch2normal", "pix2pix")
OVERLAYS = (("cpu",), ("gpu", "ddp"), ("gpu", "on_the_fly"), ("cpu", "fourleg/meshes"))
DIFFER = {
    "sketch2normal": {
        "trainer.default_root_dir",
        "data.batch_size",
        "model.generator.init_args.kernel",
        "model.generator.init_args.norm",
        "model.generator.init_args.bias",
        "model.discriminator.class_path",
        "model.hint_sampler.class_path",
        "model.generator_optimizer.init_args.lr",
        "model.discriminator_optimizer.init_args.lr",
        "model.reconstruction.init_args.composited",
        "model.noise_at_test",
    },
    "pix2pix": {
        "trainer.default_root_dir",
        "trainer.max_epochs",
        "data.batch_size",
        "model.generator.init_args.norm",
        "model.discriminator.class_path",
        "model.hint_sampler.class_path",
        "model.objective.class_path",
        "model.generator_optimizer.class_path",
        "model.discriminator_optimizer.class_path",
        "model.n_critic",
        "model.reconstruction.init_args.l1_weight",
        "model.reconstruction.init_args.hint_weight",
        "model.noise_at_test",
    },
}
"""Where the methods differ from the paper's; a class that differs brings settings of its own."""


one_parser = remember(cli.training_parser)
"""Building it takes longer than reading some files with it."""


@remember
def parsed(*names: str) -> Settings:
    """Return all settings that these configurations make together, by the CLI, defaults included."""
    files = [argument for name in names for argument in ("--config", f"configs/{name}.yaml")]
    with contextlib.chdir(ROOT), pytest.MonkeyPatch.context() as patch:
        patch.setattr(cli, "training_parser", one_parser)
        return cli.resolved_settings(files)


def written(name: str) -> Settings:
    settings: Settings = yaml.safe_load((ROOT / "configs" / f"{name}.yaml").read_text(encoding="utf-8"))
    return settings


def leaves(settings: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in settings.items():
        if isinstance(value, Mapping) and value:
            yield from leaves(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def built(settings: Settings, what: str) -> Any:
    """Return the object of a ``class_path`` and ``init_args`` of the model; networks with their size."""
    module, _, name = settings["model"][what]["class_path"].rpartition(".")
    kind = getattr(importlib.import_module(module), name)
    size = {"size": settings["data"]["size"]} if "size" in inspect.signature(kind).parameters else {}
    return kind(**size, **settings["model"][what].get("init_args", {}))


def complete() -> set[str]:
    """Return the configurations that stand alone: overlays leave the seed as it is."""
    names = (path.stem for path in (ROOT / "configs").glob("*.yaml"))
    return {name for name in names if "seed_everything" in written(name)}


def test_every_file_is_known_here() -> None:
    files = {str(p.relative_to(ROOT / "configs").with_suffix("")) for p in (ROOT / "configs").rglob("*.yaml")}
    files = {name for name in files if not name.startswith("benchmark/")}  # plans, read elsewhere
    others = {
        "deepnormals",
        "few_sketches",
        "quickstart",
        "ours",
        "lines_varied",
        "refiner",
        "shipped",
        "tuned",
        "wider",
    }
    assert files == {*others, *METHODS, "gpu", *itertools.chain(*OVERLAYS)}
    assert complete() == {"deepnormals", "quickstart", "ours", *METHODS}


@pytest.mark.parametrize(
    ("method", "overlays"),
    # Files are merged without regard to what is in them: one of the three methods stands for all.
    [*itertools.product(["paper"], OVERLAYS), ("ours", ("gpu", "fourleg/meshes"))],
    ids=lambda part: part if isinstance(part, str) else "+".join(part),
)
def test_overlays_win_and_change_nothing_else(method: str, overlays: tuple[str, ...]) -> None:
    together, alone = dict(leaves(parsed(method, *overlays))), dict(leaves(parsed(method)))
    wanted: Settings = {}
    for overlay in overlays:
        wanted |= dict(leaves(written(overlay)))
    for key, value in wanted.items():
        assert together[key] == value, key
    changed = {key for key in together.keys() | alone.keys() if together.get(key) != alone.get(key)}
    brought = {".".join(key.split(".")[:2]) for key in wanted if key.endswith("class_path")}
    assert {k for k in changed - wanted.keys() if ".".join(k.split(".")[:2]) not in brought} == set()


@pytest.mark.parametrize("method", [*METHODS, "ours"])
def test_a_gpu_changes_no_method(method: str) -> None:
    """The learning rate of ours was cut tenfold, by a figure that was worked out for the paper's batches."""
    alone, together = parsed(method), parsed(method, "gpu")
    assert together["model"] == alone["model"]
    assert together["data"] == alone["data"] | {"workers": together["data"]["workers"]}


@pytest.mark.parametrize(
    "names", [("quickstart",), *itertools.product(METHODS), ("paper", "cpu")], ids="+".join
)
def test_networks_and_objective_can_be_built(names: tuple[str, ...]) -> None:
    settings = parsed(*names)
    size = settings["data"]["size"]
    with torch.device("meta"):
        generator, discriminator = built(settings, "generator"), built(settings, "discriminator")
        condition, normal = torch.empty(1, 4, size, size), torch.empty(1, 3, size, size)
        assert generator(condition).shape == (1, 3, size, size)
        assert all(len(scores) == 1 for scores in discriminator(condition, normal))
    objective: AdversarialObjective = built(settings, "objective")
    objective.check(discriminator)
    built(settings, "hint_sampler")
    schedule = settings["model"]["lr_scheduler"]
    if schedule is not None and "T_max" in schedule["init_args"]:
        assert schedule["init_args"]["T_max"] == settings["trainer"]["max_epochs"]


@pytest.mark.parametrize(
    ("method", "generator", "discriminator"),
    [
        ("paper", 54_414_979, 54_412_929),
        # Su et al.'s, but for the scale and shift of the norm at the innermost layer, which is left out.
        ("sketch2normal", 85_024_387 - 2 * 512, 4_837_441),
        ("pix2pix", 54_414_979, 2_768_705),
    ],
)
def test_full_size_networks_have_the_published_parameters(
    method: str, generator: int, discriminator: int
) -> None:
    def parameters(network: nn.Module) -> int:
        return sum(p.numel() for p in network.parameters())

    with torch.device("meta"):
        assert parameters(built(parsed(method), "generator")) == generator
        assert parameters(built(parsed(method), "discriminator")) == discriminator


@pytest.mark.parametrize("method", DIFFER)
def test_methods_differ_only_where_they_do(method: str) -> None:
    other, paper = dict(leaves(parsed(method))), dict(leaves(parsed("paper")))
    differing = {key for key in other.keys() | paper.keys() if other.get(key) != paper.get(key)}
    classes = {key.removesuffix("class_path") for key in differing if key.endswith("class_path")}
    differing = {k for k in differing if k.endswith("class_path") or not k.startswith(tuple(classes) or "\0")}
    assert differing == DIFFER[method]


@pytest.mark.parametrize("method", DIFFER)
def test_stars_mark_the_lines_that_differ(method: str) -> None:
    def lines(name: str) -> list[tuple[str, bool]]:
        found = []
        for line in (ROOT / "configs" / f"{name}.yaml").read_text(encoding="utf-8").splitlines():
            setting, _, comment = line.partition("#")
            setting = re.sub(r"[&*](?=\w)\w+", "", setting).strip()  # anchors are called as one likes
            if setting and "default_root_dir" not in setting:
                found.append((" ".join(setting.split()), comment.strip().startswith("*")))
        return found

    paper = {setting for setting, _ in lines("paper")}
    for setting, starred in lines(method):
        assert (setting not in paper) == starred, setting


@pytest.mark.parametrize("method", METHODS)
def test_every_number_has_its_source(method: str) -> None:
    text = (ROOT / "configs" / f"{method}.yaml").read_text(encoding="utf-8")
    _, _, settings = text.partition("\ndata:\n")
    for line in settings.splitlines():
        if re.search(r"\d", line.partition("#")[0]) and "augmentation" not in line and "flip" not in line:
            assert re.search(r"\[(paper|su|pix2pix|ours)\]|no hints", line), line


def test_files_that_configurations_name_are_there() -> None:
    for name in (*complete(), "fourleg/meshes"):
        data = written(name)["data"]
        for group, key in (("split", "file"), ("reading", "orientation"), ("prediction", "sketches")):
            if key in data.get(group, {}):
                assert (ROOT / data[group][key]).exists(), f"{name}: {data[group][key]}"


def test_choices_are_made_without_the_meshes_of_the_test() -> None:
    folder = ROOT / "configs" / "fourleg"
    published, develop = (json.loads((folder / f"{name}.json").read_text()) for name in ("split", "develop"))
    assert develop["test"] == []
    assert sorted(develop["train"] + develop["val"]) == sorted(published["train"] + published["val"])
