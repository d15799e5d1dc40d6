import sys
from pathlib import Path

import pytest
from limited import SECONDS, read_limited
from sound_files import lay_out, sound, sound_checkpoint

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")

CORPUS = Path(__file__).with_name("corpus")
"""Files that broke a reader once, cut down, by reader; made for these tests, CC0."""


def check_reader(folder: Path, reader: str, sound_files: dict[str, bytes]) -> None:
    """Check that a reader takes sound files, and refuses its corpus in one sentence each."""
    good = [lay_out(folder, content, name, 0) for name, content in sound_files.items()]
    bad = sorted((CORPUS / reader).glob("*"))
    answers = read_limited(reader, [*good, *bad])
    for answer in answers[: len(good)]:
        assert answer.outcome == "read", answer
    for answer in answers[len(good) :]:
        assert answer.outcome == "refused", answer
        assert answer.name in answer.words
        assert "\n" not in answer.words
        assert answer.seconds < SECONDS


@pytest.mark.parametrize("reader", sound())
def test_sound_files_are_read_and_what_once_broke_a_reader_is_refused(tmp_path: Path, reader: str) -> None:
    check_reader(tmp_path, reader, sound()[reader])


@pytest.mark.slow  # imports torch
def test_a_sound_checkpoint_is_read(tmp_path: Path) -> None:
    check_reader(tmp_path, "checkpoint", {"small.ckpt": sound_checkpoint()})
