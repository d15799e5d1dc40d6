"""A shell completes what there is, by a script made once."""

import shutil
import subprocess
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
