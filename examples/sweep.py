"""Sweeps the learning rate over five tiny models with Optuna; replace the settings with your own.

It needs `pip install optuna`. It writes the runs into the folder sweep, which must not exist yet, because
`fit` overwrites no finished run.
"""

import json
from pathlib import Path

import optuna

from normalgan.__main__ import main

TINY = [
    *("--data.animals.count", "6", "--data.size", "32", "--data.storage.render_workers", "0"),
    *("--data.train_views", "2", "--data.val_views", "2", "--data.test_views", "2", "--data.batch_size", "4"),
    *("--model.generator.init_args.width", "4", "--model.discriminator", "null", "--trainer.max_epochs", "1"),
    *("--trainer.accelerator", "cpu", "--trainer.enable_progress_bar", "false"),
    *("--trainer.callbacks", "LearningCurve"),
]
SWEEP = Path("sweep")


def objective(trial: optuna.Trial) -> float:
    """Train a model with the learning rate of a trial, and return its best validation error."""
    rate = trial.suggest_float("rate", 1e-4, 1e-2, log=True)
    run = SWEEP / str(trial.number)
    optimizer = ["--model.generator_optimizer", "RAdam", "--model.generator_optimizer.lr", str(rate)]
    if main(["fit", *TINY, *optimizer, "--trainer.default_root_dir", str(run)]):
        raise optuna.TrialPruned  # `fit` has printed the reason to the error stream
    return min(epoch["val/hints/angular_mean"] for epoch in json.loads((run / "curve.json").read_text()))


if SWEEP.exists():
    raise SystemExit(f"{SWEEP} already holds a sweep. Move it, or change SWEEP.")
study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=0))
study.optimize(objective, n_trials=5)
print(study.best_params, study.best_value)
