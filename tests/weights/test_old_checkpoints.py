from pathlib import Path

import torch

from normalgan.models import UNetGenerator
from normalgan.weights.checkpoint import read_checkpoint


def test_a_checkpoint_from_before_the_renames_is_read_by_the_new_names(tmp_path: Path) -> None:
    settings = {
        "generator": {
            "class_path": "normalgan.models.unet_generator.UNetGenerator",
            "init_args": {"size": 32, "width": 4},
        },
        "discriminator": None,
        "hint_sampler": {"class_path": "normalgan.hints.uniform.UniformHints", "init_args": {}},
        "objective": {"class_path": "normalgan.objectives.wasserstein.Wasserstein", "init_args": {}},
        "reconstruction": {"class_path": "normalgan.objectives.l1_and_hints.L1AndHints", "init_args": {}},
        "steadiness": 1.5,
    }
    state = {f"generator.{name}": value for name, value in UNetGenerator(32, 4).state_dict().items()}
    torch.save({"hyper_parameters": settings, "state_dict": state}, tmp_path / "old.ckpt")
    checkpoint = read_checkpoint(tmp_path / "old.ckpt")
    read = checkpoint.training_settings()
    assert read["generator"]["class_path"] == "normalgan.models.unet.UNetGenerator"
    assert read["objective"]["class_path"] == "normalgan.losses.wasserstein.Wasserstein"
    assert read["reconstruction"]["class_path"] == "normalgan.losses.l1_and_hints.L1AndHints"
    assert read["distractor_consistency"] == 1.5
    assert "steadiness" not in read
    assert checkpoint.weights().notes.generator.name == "UNetGenerator"
