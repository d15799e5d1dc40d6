import sys
from pathlib import Path

import pytest
from limited import read_limited
from mutants import fault
from structures import KINDS, Chance
from test_mutations import MUTATIONS, SEED

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_of_sound_parts_is_read_or_refused(tmp_path: Path, kind: str) -> None:
    files = []
    for number in range(MUTATIONS):
        content = KINDS[kind](Chance([SEED, list(KINDS).index(kind), number]))
        files.append(tmp_path / f"{number:05d}.{kind}")
        files[-1].write_bytes(content)
    answers = read_limited("model" if kind == "onnx" else "drawing", files)
    assert [f"{answer.name}: {fault(answer)}" for answer in answers if fault(answer)] == []
    assert any(answer.outcome == "refused" for answer in answers)


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_seed_makes_the_same_file(kind: str) -> None:
    one, same, other = (KINDS[kind](Chance([seed])) for seed in (1, 1, 2))
    assert one == same != other


def test_many_of_them_get_past_the_door(tmp_path: Path) -> None:
    # Else nothing that lies behind a parser would be tried.
    sound = {"svg": 0.5, "png": 0.15, "tiff": 0.15, "gif": 0.15}
    for kind, share in sound.items():
        files = []
        for number in range(25):
            files.append(tmp_path / f"{number:05d}.{kind}")
            files[-1].write_bytes(KINDS[kind](Chance([0, list(KINDS).index(kind), number])))
        words = [
            a.words for a in read_limited("drawing", files) if a.outcome == "read" or "all white" in a.words
        ]
        assert len(words) >= share * 25, (kind, len(words))
