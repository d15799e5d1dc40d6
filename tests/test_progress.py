import pytest

from normalgan.progress import progress_bar


def shown(capsys: pytest.CaptureFixture[str], **settings: bool) -> str:
    with progress_bar("looking at", 3, "meshes", **settings) as advance:
        advance(1)
        advance(2)
    out, err = capsys.readouterr()
    assert out == ""  # which may be what another program reads
    return err


def test_a_log_file_is_left_the_full_bar_or_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert "3/3 meshes" in shown(capsys)
    assert shown(capsys, stays=False) == ""
    assert shown(capsys, shown=False) == ""


def test_a_terminal_sees_a_bar_that_is_taken_away_too(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm")
    assert "looking at" in shown(capsys, stays=False)
