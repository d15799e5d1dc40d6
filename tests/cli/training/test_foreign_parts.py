import json
from pathlib import Path

import pytest
import torch
import yaml
from command import Bench, run

from plugin_packages import install

PARTS = {
    "data.renderer": ("normalgan.renderers", "rendering.renderers", "EmbreeRenderer", "data"),
    "data.lines": ("normalgan.line_drawings", "rendering.lines", "Silhouette", "data"),
    "model.hint_sampler": ("normalgan.hint_samplers", "hints", "UniformHints", "data"),
    "model.generator": ("normalgan.generators", "models", "UNetGenerator", "network"),
    "model.discriminator": ("normalgan.discriminators", "models", "UNetDiscriminator", "network"),
    "model.objective": ("normalgan.adversarial_objectives", "losses", "CrossEntropy", "data"),
    "model.reconstruction": ("normalgan.reconstructions", "losses", "L1AndHints", "data"),
}
"""For each setting: its group, and what a package of someone else's might begin with."""
SOURCES = {
    "data": '''
from dataclasses import dataclass
from normalgan.{room} import {parent}
@dataclass(frozen=True)
class Foreign{parent}({parent}):
    """A part of somebody else's.

    Args:
        note: what it leaves as a trace.
    """

    note: int = 0
''',
    "network": '''
from normalgan.{room} import {parent}
class Foreign{parent}({parent}):
    """A part of somebody else's.

    Args:
        size: side of the pictures.
        note: what it leaves as a trace.
    """

    def __init__(self, size: int = 256, note: int = 0) -> None:
        super().__init__(size, width=4)
        self.note = note
''',
}


def offer(site: Path) -> dict[str, str]:
    """Install a package that offers one class of each kind; return the short name for each setting."""
    modules, entries = {}, {}
    for setting, (group, room, parent, source) in PARTS.items():
        module = f"foreign_{setting.partition('.')[2]}"
        modules[module] = SOURCES[source].format(room=room, parent=parent)
        entries[group] = {f"Foreign{parent}": f"{module}:Foreign{parent}"}
    install(site, "foreign", modules, entries)
    return {setting: f"Foreign{parent}" for setting, (_, _, parent, _) in PARTS.items()}


@pytest.mark.slow  # trains and tests
@pytest.mark.filterwarnings("ignore:.*LeafSpec.*is deprecated.*")
def test_every_kind_comes_from_a_package_by_short_name_through_training_and_testing(
    bench: Bench, tmp_path: Path, site: Path
) -> None:
    names = offer(site)
    settings: dict[str, dict[str, object]] = {"data": {"cache": str(tmp_path / "cache")}, "model": {}}
    for number, (setting, name) in enumerate(names.items(), 1):
        section, _, part = setting.partition(".")
        settings[section][part] = {"class_path": name, "init_args": {"note": number}}
    config = tmp_path / "foreign.yaml"
    config.write_text(yaml.safe_dump(settings))
    folder = tmp_path / "run"
    done = bench.run("fit", folder, "--config", config, "--trainer.limit_train_batches", 2)
    assert (done.code, done.err.count("warning")) == (0, 0), done.err
    last = folder / "checkpoints" / "last.ckpt"
    saved = torch.load(last, weights_only=True)["hyper_parameters"]
    for number, (setting, name) in enumerate(names.items(), 1):
        section, _, part = setting.partition(".")
        if section == "model":
            assert saved[part]["class_path"] == f"foreign_{part}.{name}"
            assert saved[part]["init_args"]["note"] == number
    recipe = json.loads(next((tmp_path / "cache").glob("*/dataset.json")).read_text())["recipe"]
    assert len(recipe["renderer"].pop("code")) == 16
    assert recipe["renderer"] == {"class": "ForeignEmbreeRenderer", "note": 1}
    assert recipe["lines"]["class"] == "ForeignSilhouette"
    again = bench.run("test", folder, "--config", config, "--ckpt_path", last)
    assert again.code == 0, again.err


def test_help_lists_foreign_parts_with_their_summaries_and_a_typo_is_answered(
    site: Path, tmp_path: Path
) -> None:
    names = offer(site)
    shown = run("fit", "--help", "all").out
    for setting, name in names.items():
        assert f"--{setting}\n" in shown
        assert any(
            line.split() == [name, "A", "part", "of", "somebody", "else's."] for line in shown.splitlines()
        )
    run("fit", f"--{setting}", f"{name}s").refused(f"named '{name}s'. Did you mean {name}?")
