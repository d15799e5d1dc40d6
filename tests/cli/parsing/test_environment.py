"""${NAME} in a configuration is the environment variable of that name."""

from pathlib import Path

import pytest
import yaml
from command import run

from normalgan.cli.parsing.config_files import load_bounded, with_environment
from normalgan.errors import InputError


def test_a_configuration_reads_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RUNS", str(tmp_path / "here"))
    monkeypatch.setenv("PIXELS", "64")
    config = tmp_path / "c.yaml"
    config.write_text(
        "trainer: {default_root_dir: '${RUNS}/a'}\n"
        "data: {size: '${PIXELS}', meshes: '${oc.env:NO_SUCH_VARIABLE,meshes}/${oc.env:PIXELS}'}\n"
    )
    done = run("fit", "--config", config, "--print_config")
    assert done.code == 0, done.err
    settings = yaml.safe_load(done.out)
    assert settings["trainer"]["default_root_dir"] == f"{tmp_path}/here/a"
    assert settings["data"]["size"] == 64
    assert settings["data"]["meshes"] == "meshes/64"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("${NO_SUCH_VARIABLE}/a", "the environment has no NO_SUCH_VARIABLE"),
        ("${data.size}", r"\$\{data.size\} is not an environment variable"),
        ("${}", "is not an environment variable"),
    ],
)
def test_an_invalid_variable_is_refused(text: str, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        with_environment({"a": [text]})


def test_an_unset_variable_leaves_no_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("c.yaml").write_text("data: {cache: '${NO_SUCH_VARIABLE}'}\n")
    run("fit", "--config", "c.yaml").refused("the environment has no NO_SUCH_VARIABLE")
    run("fit", "--data.cache", "${NO_SUCH_VARIABLE}/a").refused("the environment has no NO_SUCH_VARIABLE")
    assert [path.name for path in tmp_path.iterdir()] == ["c.yaml"]


@pytest.mark.parametrize("text", ["a: ${HOME}", "${oc.env:HOME}/trainer.yaml"])
def test_a_configuration_that_is_not_trusted_reads_no_environment(text: str) -> None:
    with pytest.raises(InputError, match="which --safe-config does not allow"):
        load_bounded(text, yaml.safe_load, safe=True)
