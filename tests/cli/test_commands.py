import csv
import json
import re
import shutil
import signal
from pathlib import Path

import numpy as np
import pytest
import yaml
from command import CONF, Bench, left_in, run
from PIL import Image

from normal_pngs import read_png
from normalgan.__main__ import main
from normalgan.cli.training.help import SECTIONS
from reported import figures_of


def last(folder: Path) -> Path:
    return folder / "checkpoints" / "last.ckpt"


def disc(path: Path, width: int, height: int) -> None:
    y, x = np.mgrid[:height, :width]
    distance = np.hypot(x - width / 2, y - height / 2) - 0.35 * min(width, height)
    Image.fromarray(np.where(np.abs(distance) < 1.5, 0, 255).astype(np.uint8)).save(path)


def test_fit_leaves_checkpoints_curves_and_its_settings(trained: Path) -> None:
    names = left_in(trained)
    assert "checkpoints/last.ckpt" in names
    assert any(re.fullmatch(r"checkpoints/0\d\d-\d+\.\d\d\.ckpt", name) for name in names)
    assert any("tfevents" in name for name in names)
    assert yaml.safe_load((trained / "config.yaml").read_text())["data"]["size"] == 32
    assert not any(name.endswith((".tmp", ".part")) for name in names)


def test_fit_prints_no_warnings_that_users_cannot_act_on(bench: Bench, tmp_path: Path) -> None:
    outcome = bench.run("fit", tmp_path / "run", "--trainer.enable_model_summary", "false")
    assert (outcome.code, outcome.err) == (0, "")
    (line,) = outcome.out.splitlines()
    assert line.startswith("The best checkpoint is ")


@pytest.mark.slow
def test_a_resumed_run_keeps_the_table_that_it_logged_before(
    bench: Bench, trained: Path, tmp_path: Path
) -> None:
    assert trained  # its samples are rendered, which is said on the error stream
    loggers = ("--trainer.logger", "[CSVLogger, TensorBoardLogger]")
    for more in ((), ("--trainer.max_epochs", 2, "--ckpt_path", "last")):
        outcome = bench.run("fit", tmp_path, *loggers, *more, "--trainer.enable_model_summary", "false")
        assert (outcome.code, outcome.err) == (0, "")
    tables = sorted(tmp_path.glob("lightning_logs/version_*/metrics.csv"))
    epochs = [next(csv.DictReader(table.read_text().splitlines()))["epoch"] for table in tables]
    assert epochs == ["0", "1"]
    assert (tmp_path / "config.yaml").is_file()


@pytest.mark.slow
def test_the_settings_of_a_resumed_run_begin_another_run(bench: Bench, trained: Path, tmp_path: Path) -> None:
    shutil.copytree(trained, tmp_path / "first")
    resumed = bench.run("fit", tmp_path / "first", "--ckpt_path", "last", "--trainer.max_epochs", 9)
    assert resumed.code == 0, resumed.err
    settings = ("--config", tmp_path / "first" / "config.yaml")
    again = run("fit", *settings, "--trainer.default_root_dir", tmp_path / "again", "--trainer.max_epochs", 1)
    assert again.code == 0, again.err
    assert "Nothing was left to train" not in again.out
    assert last(tmp_path / "again").is_file()
    # The checkpoint may come before the settings, which do not take it away.
    assert run("validate", "--ckpt_path", "last", *settings).code == 0


@pytest.mark.slow
def test_the_settings_that_fit_saves_are_a_configuration(bench: Bench, trained: Path, tmp_path: Path) -> None:
    outcome = run(
        *("fit", "--config", trained / "config.yaml", "--trainer.default_root_dir", tmp_path / "again"),
        *("--trainer.max_epochs", 1),
    )
    assert outcome.code == 0, outcome.err
    assert last(tmp_path / "again").is_file()


@pytest.mark.slow
def test_validate_prints_the_metrics(bench: Bench, trained: Path, tmp_path: Path) -> None:
    outcome = bench.run("validate", tmp_path, "--ckpt_path", last(trained))
    assert outcome.code == 0, outcome.err
    assert "val/no_hints/angular_mean" in outcome.out


def test_test_leaves_table_and_gallery_and_the_settings_of_fit(bench: Bench, trained: Path) -> None:
    settings = (trained / "config.yaml").read_text()
    outcome = bench.run("test", trained, "--ckpt_path", "last")
    assert outcome.code == 0, outcome.err
    results = figures_of(trained)
    assert {"hints", "no_hints", "constant", "mean_map"} <= results.keys()
    assert str(trained / "test" / "last" / "gallery.png") in outcome.out.replace("\n", "")
    with Image.open(trained / "test" / "last" / "gallery.png") as gallery:
        assert gallery.width > gallery.height > 200
    assert (trained / "config.yaml").read_text() == settings


def test_predict_writes_each_map_at_the_size_of_its_sketch(
    bench: Bench, trained: Path, tmp_path: Path
) -> None:
    (tmp_path / "sketches").mkdir()
    disc(tmp_path / "sketches" / "wide.png", 90, 50)
    disc(tmp_path / "sketches" / "tall.jpg", 40, 70)
    outcome = bench.run(
        "predict",
        tmp_path,
        *("--ckpt_path", last(trained), "--data.prediction.sketches", tmp_path / "sketches"),
        *("--output.folder", tmp_path / "maps"),
    )
    assert outcome.code == 0, outcome.err
    assert str(tmp_path / "maps") in outcome.out
    assert left_in(tmp_path / "maps") == ["tall_normal.png", "wide_normal.png"]
    normals, _ = read_png(tmp_path / "maps" / "wide_normal.png")
    assert normals.shape == (50, 90, 3)
    assert np.ptp(normals[20:30, 40:50], axis=(0, 1)).max() > 0.1  # and something was, here
    assert normals[0, 0].round(1).tolist() == [0, 0, 1]  # nothing was drawn there
    header = (tmp_path / "maps" / "tall_normal.png").read_bytes()[:26]
    assert (header[24], header[25]) == (8, 2)  # PNG 11.2.2: bit depth, and colour type RGB


@pytest.mark.slow
def test_render_fills_the_cache_and_stops_there(bench: Bench, tmp_path: Path) -> None:
    again = ("--data.cache", tmp_path / "cache", "--data.train_views", 1)
    outcome = bench.run("render", tmp_path / "run", *again)
    assert outcome.code == 0, outcome.err
    assert "7/7 samples" in outcome.err  # three meshes once, one and one twice
    manifest = json.loads(next((tmp_path / "cache").glob("*/dataset.json")).read_text())
    assert manifest["samples"] == {"train": 3, "val": 2, "test": 2}
    assert not (tmp_path / "run").exists()
    assert "rendering" not in bench.run("render", tmp_path / "run", *again).err


def test_the_first_page_of_help_lists_what_the_command_uses() -> None:
    shown = {command: run(command, "--help").out for command in ("fit", "predict", "render")}
    settings = ("--data.prediction.sketches", "--output.folder", "--trainer.max_epochs", "--ckpt_path")
    found = {command: [name for name in settings if name in page] for command, page in shown.items()}
    assert found == {"fit": [*settings[2:]], "predict": [*settings[:2], settings[3]], "render": []}


@pytest.mark.parametrize("command", ["fit", "predict"])
def test_help_of_all_opens_with_one_line_and_lists_the_plugins(command: str) -> None:
    outcome = run(command, "--help=all")
    assert outcome.code == 0
    assert outcome.out.startswith(f"usage: normalgan {command} ")
    assert outcome.out.index("\n\n") < 200
    for name in ("UNetGenerator", "GlobalDiscriminator", "CurvatureHints", "Wasserstein", "PyrenderRenderer"):
        assert name in outcome.out
    assert "rendered samples are stored" in " ".join(outcome.out.split())  # docstrings are the help


def test_help_is_a_page_that_leads_to_the_rest() -> None:
    """It was 965 lines; each section, and each setting that it names, is there."""
    page = run("fit", "--help").out
    assert len(page.splitlines()) < 40
    assert max(map(len, page.splitlines())) <= 120
    every = run("fit", "--help", "all").out
    for option in re.findall(r"^  (--[\w.-]+)", page, re.MULTILINE):
        assert re.search(rf"^ .*{option}\b", every, re.MULTILINE) or option in every.splitlines()[0], option
    for section in SECTIONS:
        assert f"normalgan fit --help {section} " in page
        assert f"\n  --{section}." in every
    assert set(re.findall(r"^  --(\w+)\.", every, re.MULTILINE)) == set(SECTIONS)


def test_help_of_a_section_lists_its_settings_alone_and_its_plugins() -> None:
    outcome = run("test", "--config", "configs/paper.yaml", "--help", "model")
    assert outcome.code == 0, outcome.err
    settings = [line.split()[0] for line in outcome.out.splitlines() if line.startswith("  --")]
    assert all(setting.startswith("--model") for setting in settings)
    assert {"--model.n_critic", "--model.hint_sampler"} <= set(settings)
    assert "UniformHints" in outcome.out
    assert "EmbreeRenderer" not in outcome.out
    run("fit", "--help", "modle").refused("no section 'modle'. Did you mean model?", "checkpoint", "all")


def test_help_of_a_plugin_lists_its_settings() -> None:
    outcome = run("fit", "--model.hint_sampler.help", "UniformHints")
    assert outcome.code == 0
    assert "--model.hint_sampler.init_args." in outcome.out or "--model.hint_sampler." in outcome.out


def test_configurations_compose_and_options_have_the_last_word(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("data: {batch_size: 7, train_views: 9}\nmodel: {n_critic: 2}\n")
    (tmp_path / "b.yaml").write_text("data: {batch_size: 8}\n")
    outcome = run(
        "fit",
        *("--config", CONF / "tiny.yaml", "--config", tmp_path / "a.yaml", "--config", tmp_path / "b.yaml"),
        *("--model.n_critic", 3, "--print_config"),
    )
    assert outcome.code == 0, outcome.err
    settings = yaml.safe_load(outcome.out)
    assert (settings["data"]["batch_size"], settings["data"]["train_views"]) == (8, 9)
    assert (settings["data"]["size"], settings["model"]["n_critic"]) == (32, 3)
    assert settings["model"]["generator"]["init_args"]["width"] == 4


def test_a_short_name_keeps_the_settings_given_beside_it(bench: Bench, tmp_path: Path) -> None:
    outcome = run(
        "fit", "--model.hint_sampler", "UniformHints", "--model.generator.width", 8, "--print_config"
    )
    settings = yaml.safe_load(outcome.out)["model"]
    assert settings["hint_sampler"]["class_path"] == "normalgan.hints.UniformHints"
    assert settings["generator"]["init_args"]["width"] == 8


def test_ctrl_c_ends_with_its_own_code(bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("normalgan.gan.NormalGAN.training_step", interrupt)
    handler = signal.getsignal(signal.SIGINT)
    outcome = bench.run("fit", tmp_path)
    outcome.refused("stopped.", code=130)
    assert signal.getsignal(signal.SIGINT) == handler


def test_a_name_with_a_line_end_or_a_terminal_command_is_printed_as_one_line(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In what commands print about success, as in their messages."""
    name = "red\x1b[31m\nfox"
    picture = np.full((64, 64, 3), 255, np.uint8)
    picture[16:48, 16] = picture[16:48, 47] = picture[16, 16:48] = picture[47, 16:48] = 0
    Image.fromarray(picture).save(f"{name}.png")
    Image.fromarray(np.full((64, 64, 3), (128, 128, 255), np.uint8)).save("map.png")
    for arguments in (
        ("generate", f"{name}.png", "--dry-run"),
        ("generate", f"{name}.png"),
        ("convert", "map.png", "-o", f"{name}.tif"),
        ("sketch", "horse-3", "--size", "64", "-o", f"{name}.svg"),
    ):
        assert main([*arguments]) == 0
        (line,) = capsys.readouterr().out.splitlines()
        assert r"red\x1b[31m\nfox" in line
        assert line.isprintable()
