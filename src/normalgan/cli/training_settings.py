"""The settings of the training commands besides those of model, data and trainer, and all defaults."""

from lightning.pytorch.callbacks import ModelCheckpoint
from lightning.pytorch.cli import LightningArgumentParser

from normalgan.callbacks import PictureLogger, TestReport
from normalgan.callbacks.checkpoints import checkpoint_folder, run_folder
from normalgan.cli.number_types import Strength
from normalgan.cli.output_options import add_output_options

__all__ = ["add_settings"]

_OPTIMIZER = {"class_path": "torch.optim.RMSprop", "init_args": {"lr": 5e-5, "alpha": 0.9}}
_DEFAULTS = {
    "model.generator": {"class_path": "normalgan.models.UNetGenerator"},
    "model.discriminator": {"class_path": "normalgan.models.UNetDiscriminator"},
    "model.hint_sampler": {"class_path": "normalgan.hints.CurvatureHints"},
    "model.objective": {"class_path": "normalgan.losses.Wasserstein"},
    "model.reconstruction": {"class_path": "normalgan.losses.L1AndHints"},
    # Named, so that an overlay or a single option can change one of their settings.
    "model.generator_optimizer": _OPTIMIZER,
    "model.discriminator_optimizer": _OPTIMIZER,
    "trainer.logger": {
        "class_path": "lightning.pytorch.loggers.TensorBoardLogger",
        "init_args": {"save_dir": "runs", "name": "", "version": "", "default_hp_metric": False},
    },
    "trainer.plugins": {"class_path": "normalgan.callbacks.checkpoints.AtomicCheckpointIO"},
    "checkpoint.monitor": "val/hints/angular_mean",
    "checkpoint.filename": "{epoch:03d}-{val/hints/angular_mean:.2f}",
    "checkpoint.auto_insert_metric_name": False,
    "checkpoint.enable_version_counter": False,
}


def add_settings(parser: LightningArgumentParser) -> None:
    """Add settings and defaults to a parser that has those of model, data and trainer.

    Folders follow from the run's folder, and the size of the networks from that of the pictures.
    """
    parser.add_lightning_class_args(ModelCheckpoint, "checkpoint")
    parser.add_lightning_class_args(PictureLogger, "pictures")
    parser.add_lightning_class_args(TestReport, "report")
    group = parser.add_argument_group("What predict writes for each drawing")
    group.add_argument("--output.folder", type=str, default="normals", help="where the maps go")
    group.add_argument(
        "--output.strength", type=Strength, default=1.0, help="what the slopes of the map are multiplied by"
    )
    add_output_options(parser, group, "output.")
    parser.set_defaults(_DEFAULTS)
    for action in parser._actions:
        if action.dest in _DEFAULTS:
            action.required = False  # it has a default here, if not in Python
    root = "trainer.default_root_dir"
    parser.link_arguments(root, "trainer.logger.init_args.save_dir", compute_fn=run_folder)
    parser.link_arguments(root, "checkpoint.dirpath", compute_fn=checkpoint_folder)
    for network in ("generator", "discriminator"):
        parser.link_arguments("data.size", f"model.{network}.init_args.size")
