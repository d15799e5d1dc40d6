import importlib.util
from pathlib import Path

import pytest
import yaml
from command import CONF, Bench, left_in, run
from lightning.pytorch.tuner.tuning import Tuner

from normalgan.cli.training.trainer import refused_by_lightning
from normalgan.errors import InputError
from small import QUIET, data, gan, trainer

PLUGINS = {
    "model.generator": ("UnetGenerator", "Generator", "UNetGenerator"),
    "data.lines": ("SugestiveContours", "LineDrawing", "SuggestiveContours"),
}


def near_miss(setting: str) -> str:
    given, base, meant = PLUGINS[setting]
    return f'argument "{setting}": no {base} named {given!r}. Did you mean {meant}? Known: '


@pytest.mark.parametrize("setting", PLUGINS)
def test_an_unknown_plugin_is_answered_by_its_near_miss(setting: str) -> None:
    run("fit", f"--{setting}", PLUGINS[setting][0]).refused(near_miss(setting))


def test_an_unknown_plugin_in_a_file_is_answered_by_its_near_miss(tmp_path: Path) -> None:
    setting = "data.lines"
    given, (section, name) = PLUGINS[setting][0], setting.split(".")
    short, nested = tmp_path / "short.yaml", tmp_path / "nested.yaml"
    short.write_text(f"{section}:\n  {name}: {given}\n")
    nested.write_text(f"{section}:\n  {name}:\n    class_path: {given}\n    init_args: {{width: 4}}\n")
    for config in (short, nested):
        run("fit", "--config", config).refused(near_miss(setting))


@pytest.mark.parametrize(
    ("yaml", "words"),
    [
        ("model: {generator: {class_path: PatchDiscriminator}}", ["no Generator named 'PatchDiscriminator'"]),
        (
            "model: {hint_sampler: {class_path: gone.Dots}}",
            ["gone.Dots cannot be imported", "UniformHints", "run python -m normalgan in the folder of gone"],
        ),
        ("model: {hint_sampler: HintSampler}", ["HintSampler is abstract; name a class that defines all of"]),
        (
            "data: {lines: normalgan.hints.NoHints}",
            ["normalgan.hints.NoHints is not a LineDrawing; known: Brush,"],
        ),
        ("data: {source: Pairs}", ["Pairs needs its settings files; give them in init_args."]),
        ("model: {hint_sampler: 3}", ["3 is not a HintSampler", "CurvatureHints"]),
        ("model: {generator_optimizer: RMSProp}", ["no Optimizer named 'RMSProp'. Did you mean RMSprop?"]),
        (
            "model: {lr_scheduler: ReduceLROnPlateau}",
            ["several classes are named ReduceLROnPlateau; give the full name: torch.optim.lr"],
        ),
        ("model: {lr_scheduler: {class_path: StepLR}}", ["model.lr_scheduler", "missing: step_size"]),
        ("trainer: {callbacks: [{class_path: EarlyStoping}]}", ["Did you mean EarlyStopping?"]),
        (
            "model: {generator: {class_path: UNetGenerator, init_args: {widht: 4}}}",
            ["'widht'", "mean width?"],
        ),
        (
            "model: {generator: {class_path: UNetGenerator, init_args: {width: wide}}}",
            ["a whole number, not wide"],
        ),
        ("data: {views: {margin: wide}}", ['"data.views.margin": expected a number, not wide.']),
        ("data: {animals: 30}", ["data.animals is a group of settings, such as data.animals.count, not 30"]),
        ("data: {views: {margn: 0.1}}", ["no setting data.views.margn. Did you mean data.views.margin?"]),
        ("data: {meshes: {a: 1}}", ["expected text or a list or null, not {'a': 1}"]),
        ("data: {split: {fractions: [0.5, 0.5]}}", ["expected a tuple with 3 elements, not [0.5, 0.5]."]),
        ("data:", ['"data" in the configuration', "is empty"]),
        ("trainer: 3", ['"trainer" in the configuration', "is 3"]),
        ("trainer: {max_epochs: many}", ["expected a whole number or null, not many."]),
        ("output: {engine: unity}", ["there is no setting output.engine."]),
        ("data: [1", ["bad.yaml is not YAML: line 1: "]),
        (
            "data: {size: 32}\ntrainer: {}\ndata: {batch_size: 2}",
            ["line 3: data was given in line 1 already."],
        ),
        ("data: {size: 32}\n---\ndata: {size: 64}", ["expected a single document in the stream but found"]),
        ("seed_everything: -1", ["seed_everything is -1; it must be from 0 to 4294967295."]),
        (
            "model: {generator: {UNetGenerator: {width: 4}}}",
            ["UNetGenerator.width is not a setting of it; write class_path and init_args."],
        ),
        ("model: {generator: {classpath: UNetGenerator}}", ["'classpath' in it. Did you mean class_path?"]),
        ("data:\n\tsize: 3", ["bad.yaml is not YAML: line 2: ", "; indent with spaces."]),
        ("just words", ["bad.yaml holds no settings"]),
        ("\x00\x01", ["bad.yaml is not YAML text"]),
    ],
)
def test_a_bad_setting_is_one_sentence(tmp_path: Path, yaml: str, words: list[str]) -> None:
    config = tmp_path / "bad.yaml"
    config.write_text(yaml)
    run("fit", "--config", config, "--trainer.default_root_dir", tmp_path / "run").refused(*words)
    assert left_in(tmp_path) == ["bad.yaml"]


@pytest.mark.parametrize(
    ("yaml", "words"),
    [
        ("data: {size: 48}", ["a power of two", "not 48"]),
        ("data: {batch_size: 0}", ["batch_size of MeshDataModule is 0; it must be 1 or more."]),
        ("trainer: {accelerator: quantum}", ["a setting cannot be used", "accelerator='quantum'"]),
        (
            "model: {generator_optimizer: {class_path: RMSprop, init_args: {lr: -1}}}",
            ["generator_optimizer cannot be used: Invalid learning rate: -1.0."],
        ),
        ("trainer: {accelerator: tpu}", ["trainer.accelerator is tpu, which PyTorch", "use cpu or auto"]),
        (
            "trainer: {gradient_clip_val: 1.0}",
            ["trainer.gradient_clip_val cannot", "use model.gradient_clip."],
        ),
        ("trainer: {accumulate_grad_batches: 4}", ["accumulate_grad_batches cannot", "data.batch_size."]),
        ("checkpoint: {monitor: val/eror}", ["val/eror"]),
    ],
)
def test_a_setting_that_its_class_refuses_is_one_sentence(
    bench: Bench, tmp_path: Path, yaml: str, words: list[str]
) -> None:
    config = tmp_path / "bad.yaml"
    config.write_text(yaml)
    bench.run("fit", tmp_path / "run", "--config", config).refused(*words)
    assert not [name for name in left_in(tmp_path) if name.endswith(".ckpt")]


def test_options_are_checked_like_settings(bench: Bench, tmp_path: Path) -> None:
    run("fit", "--modle.n_critic", 3).refused("no setting modle.n_critic. Did you mean model.n_critic?")
    run("fit", "--model.n_critic").refused("--model.n_critic needs a value.")
    run("fit", "cpu.yaml").refused("'cpu.yaml' is not an option; write --config FILE,")
    run("fit", "--config").refused("--config needs a value.")
    run("fit", "--config", tmp_path / "gone.yaml").refused("there is no configuration file", "gone.yaml")
    run("fit", "--config", tmp_path).refused("cannot be read: Is a directory")


@pytest.mark.parametrize("setting", ["max_epochs", "max_steps", "limit_train_batches"])
def test_a_run_that_would_train_nothing_is_refused(bench: Bench, tmp_path: Path, setting: str) -> None:
    done = bench.run("fit", tmp_path / "run", f"--trainer.{setting}", 0)
    done.refused(f"trainer.{setting} is 0, so fit would train nothing; increase or omit it.")


@pytest.mark.slow  # builds a run
def test_a_run_that_ends_before_its_first_step_says_so(bench: Bench, tmp_path: Path) -> None:
    done = bench.run("fit", tmp_path / "run", "--trainer.max_time", "00:00:00:00")
    assert (done.code, done.out.splitlines()[-1]) == (
        0,
        "Nothing was trained: the run ended before its first step.",
    )


def test_the_folder_of_the_run_can_be_none(bench: Bench, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    bench.run("fit", tmp_path / "file" / "run").refused("file/run", "folder")


def test_an_option_is_not_completed_from_its_beginning(bench: Bench, tmp_path: Path) -> None:
    """As in YAML, where it is refused too."""
    outcome = bench.run("fit", tmp_path / "run", "--trainer.max_epoch", 3)
    outcome.refused("trainer.max_epoch", "Did you mean", "trainer.max_epochs")


def test_a_run_needs_no_folder_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Then it is the working directory, as for Lightning; the logger was given none at all."""
    monkeypatch.chdir(tmp_path)
    outcome = run("fit", "--config", CONF / "tiny.yaml", "--print_config")
    assert yaml.safe_load(outcome.out)["trainer"]["default_root_dir"] is None
    outcome = run("fit", "--config", CONF / "tiny.yaml", "--data.size", 48)
    outcome.refused("a power of two", "not 48")  # of the networks, which are built after the trainer's parts


def test_settings_with_a_default_are_not_required(bench: Bench, tmp_path: Path) -> None:
    help_page = run("fit", "--help", "model").out
    for name in ("generator", "discriminator", "hint_sampler", "objective"):
        (line,) = (line for line in help_page.splitlines() if line.strip().startswith(f"--model.{name} "))
        assert "required" not in help_page[help_page.index(line) :][:400].split("--model.", 2)[1]


@pytest.mark.parametrize("strategy", [(), ("--trainer.strategy", "ddp")])
def test_plain_ddp_is_refused_before_any_process_starts(
    bench: Bench, tmp_path: Path, strategy: tuple[str, ...]
) -> None:
    outcome = bench.run("fit", tmp_path / "run", "--trainer.devices", 2, *strategy)
    outcome.refused("(ddp)" if not strategy else "is ddp,", "--config ddp", "ddp_find_unused_parameters_true")


@pytest.mark.filterwarnings("ignore:.*was trained with other settings.*")
def test_a_measurement_of_nothing_is_refused(bench: Bench, tmp_path: Path) -> None:
    for command, setting in (("validate", "limit_val_batches"), ("test", "limit_test_batches")):
        given = (f"--trainer.{setting}", 0, "--ckpt_path", "shipped", "--data.size", 256)
        outcome = bench.run(command, tmp_path / "run", *given)
        assert outcome.code == 2
        assert f"trainer.{setting} is 0, so {command} would measure nothing" in outcome.err


@pytest.mark.skipif(importlib.util.find_spec("wandb") is not None, reason="wandb is installed")
def test_a_logger_that_is_not_installed_is_named_with_the_reason(bench: Bench, tmp_path: Path) -> None:
    outcome = bench.run("fit", tmp_path / "run", "--trainer.logger", "WandbLogger")
    outcome.refused("WandbLogger: ", "'wandb")


@pytest.mark.filterwarnings(*QUIET)
def test_the_tuner_of_lightning_is_refused(meshes: Path, cache: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="LearningRateFinder cannot be used"):
        Tuner(trainer(tmp_path)).lr_find(gan(), data(meshes, cache))


@pytest.mark.slow
def test_a_setting_that_lightning_refuses_while_it_runs_is_an_error_in_the_settings(
    bench: Bench, tmp_path: Path
) -> None:
    # It raises plain ValueErrors and RuntimeErrors, which used to be reported as bugs, with exit code 1.
    for number, given in enumerate(
        [
            ("--trainer.val_check_interval", 200),
            ("--trainer.callbacks", "EarlyStopping", "--trainer.callbacks.monitor", "val/own"),
        ]
    ):
        outcome = bench.run("fit", tmp_path / str(number), *given)
        outcome.refused("a setting cannot be used: ", str(given[-1]))
    outcome.refused("use any of the following: `val/hints/")  # of dozens, those that one stops by
    bug = RuntimeError("of a plug-in")
    with pytest.raises(RuntimeError) as raised:
        raise bug
    assert not refused_by_lightning(raised.value)
