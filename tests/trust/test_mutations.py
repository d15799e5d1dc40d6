import os
import sys
from collections.abc import Callable
from functools import cache
from itertools import chain, islice
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from limited import Answer, EndedError, read_limited
from mutants import fault, lay_out_mutants
from mutator import mutated
from seeds_of_mutants import lay_out, sound, sound_checkpoint

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")

MUTATIONS = int(os.environ.get("NORMALGAN_MUTATIONS", "25"))
"""How many mutants each reader gets."""
SEED = int(os.environ.get("NORMALGAN_MUTATION_SEED", "0"))
SOUND = sound()
CORPUS = Path(__file__).with_name("corpus")
"""Files that mutants which broke a reader were cut down to, by reader; made for these tests, CC0."""


class Answers(NamedTuple):
    """What a reader made of sound files, of their mutants, and of the files that once broke it."""

    sound: list[Answer]
    mutants: list[Answer]
    corpus: list[Answer]


def read_all(folder: Path, reader: str, kinds: dict[str, bytes], seed: int) -> Answers:
    """Have all of them read in one process, which takes longer to begin than to read them."""
    (folder / "sound").mkdir()
    files = (
        [lay_out(folder / "sound", content, name, 0) for name, content in kinds.items()],
        lay_out_mutants(folder, kinds, MUTATIONS, [SEED, seed]),
        sorted((CORPUS / reader).glob("*")),
    )
    answers = iter(read_limited(reader, list(chain(*files))))
    return Answers(*(list(islice(answers, len(part))) for part in files))


@pytest.fixture(scope="module", name="read_by")
def make_read_by(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Answers]:
    """A function that returns a reader's answers; it asks each reader once."""

    @cache
    def read(reader: str) -> Answers:
        seed = list(SOUND).index(reader)
        return read_all(tmp_path_factory.mktemp(reader), reader, SOUND[reader], seed)

    return read


def check_mutants(answers: Answers) -> None:
    """Hold a reader to reading or refusing each mutant, within the limits."""
    # Else all mutants would be refused at the door, and nothing would be tried.
    for answer in answers.sound:
        assert answer.outcome == "read", answer
    assert [f"{answer.name}: {fault(answer)}" for answer in answers.mutants if fault(answer)] == []
    assert any(answer.outcome == "refused" for answer in answers.mutants)


@pytest.mark.parametrize("reader", SOUND)
def test_a_mutant_is_read_or_refused(read_by: Callable[[str], Answers], reader: str) -> None:
    check_mutants(read_by(reader))


@pytest.mark.slow  # imports torch
def test_a_mutant_of_a_checkpoint_is_read_or_refused(tmp_path: Path) -> None:
    check_mutants(read_all(tmp_path, "checkpoint", {"small.ckpt": sound_checkpoint()}, len(SOUND)))


@pytest.mark.parametrize("reader", [folder.name for folder in CORPUS.iterdir()])
def test_what_once_broke_a_reader_is_refused(read_by: Callable[[str], Answers], reader: str) -> None:
    answers = read_by(reader).corpus
    assert answers
    for answer in answers:
        assert answer.outcome == "refused", answer


def test_the_mutator_repeats_itself_and_changes_something() -> None:
    content = SOUND["mesh"]["ball.off"]
    one, same, other = (mutated(content, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert one == same
    assert one not in {content, other}


def test_a_process_that_ends_is_told_from_one_that_answers(tmp_path: Path) -> None:
    files = [lay_out(tmp_path, SOUND["split"]["split.json"], "split.json", number) for number in range(2)]
    with pytest.raises(EndedError, match="KeyError: 'nosuch'") as ended:
        read_limited("nosuch", files)
    assert ended.value.answers == []
    assert ended.value.file == files[0]
