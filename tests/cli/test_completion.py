"""A shell completes what there is, by a script made once."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from normalgan.__main__ import COMMANDS, main
from normalgan.cli.completion import completion_script


def completed(script: Path, *words: str) -> list[str]:
    """Return what bash offers for the last of the words."""
    line = " ".join(f"'{word}'" for word in words)
    code = (
        f"source '{script}'; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; "
        f"_shtab_normalgan normalgan '{words[-1]}' '{words[-2]}'; echo \"${{COMPREPLY[@]}}\""
    )
    shell = shutil.which("bash")
    assert shell is not None
    return subprocess.run([shell, "-c", code], capture_output=True, text=True, check=True).stdout.split()


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_bash_completes_commands_settings_and_classes(tmp_path: Path) -> None:
    pytest.importorskip("shtab", reason="shtab is not installed")
    script = tmp_path / "normalgan.bash"
    script.write_text(completion_script("bash", ["render"]))
    offered = set(completed(script, "normalgan", ""))
    assert {"render", "generate", "studio", "benchmark"} <= offered <= set(COMMANDS)
    assert "--data.batch_size" in completed(script, "normalgan", "render", "--data.b")
    assert "--preview" in completed(script, "normalgan", "generate", "--prev")
    assert completed(script, "normalgan", "render", "--data.lines", "Sug") == ["SuggestiveContours"]
    assert completed(script, "normalgan", "render", "--model.generator.help", "UN") == ["UNetGenerator"]


NESTED = """
from torch.nn import Module
from normalgan.__main__ import main
from normalgan.hints import HINT_SAMPLERS, HintSampler

@HINT_SAMPLERS.register
class Mixed(HintSampler):
    def __init__(self, inner: HintSampler%s, network: Module) -> None: ...
    def sample(self, normal, mask, rng): ...

raise SystemExit(main(["completion", "bash"]))
"""


@pytest.mark.slow
@pytest.mark.parametrize("optional", [True, False])
def test_a_plug_in_within_another_of_its_kind_is_completed_once_or_refused(optional: bool) -> None:
    pytest.importorskip("shtab", reason="shtab is not installed")
    code = NESTED % (" | None" if optional else "")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    if optional:
        assert (done.returncode, done.stderr) == (0, "")
        assert "--model.hint_sampler.inner" in done.stdout
        assert "--model.hint_sampler.network" in done.stdout
        assert not re.search(r"--model\.hint_sampler\.\w+\.(inner|network)", done.stdout)
    else:
        assert (done.returncode, done.stdout) == (2, "")
        assert len(done.stderr.splitlines()) == 1
        assert "let Mixed(inner) be None too" in done.stderr


def test_an_unknown_shell_and_a_missing_package_are_one_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["completion", "fish"]) == 2
    assert "fish" in capsys.readouterr().err
    monkeypatch.setattr("normalgan.cli.completion.find_spec", lambda name: None)
    assert main(["completion", "bash"]) == 2
    assert capsys.readouterr().err == (
        "normalgan: completion needs shtab; install it with pip install 'normalgan[completion]'.\n"
    )
