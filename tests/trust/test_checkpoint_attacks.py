"""Every attack on a checkpoint, in this process: nothing is imported, run, or taken for sound."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import torch
from attacked_checkpoints import EVIL, FILES, IGNORED, MODEL, RESUMED, TRAINING, save, sound

from normalgan.errors import InputError
from normalgan.weights.checkpoint import read_checkpoint


@pytest.fixture(name="here")
def make_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder to work in, with a module that leaves ``touched`` there if it is imported."""
    (tmp_path / f"{EVIL}.py").write_text("from pathlib import Path\nPath('touched').touch()\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    assert EVIL not in sys.modules
    assert not (tmp_path / "touched").exists()


def refused(path: Path, words: str, training: bool) -> None:
    def use() -> object:
        checkpoint = read_checkpoint(path)
        return checkpoint.training_settings() if training else checkpoint.weights(32)

    with pytest.raises(InputError) as refusal:
        use()
    said = str(refusal.value)
    assert words in said
    assert str(path) in said
    assert "\n" not in said
    assert len(said) < 600 + len(str(path))


def test_a_sound_one_is_read(here: Path) -> None:
    checkpoint = read_checkpoint(save(here / "sound.ckpt"))
    settings = checkpoint.training_settings()
    given = sound()["hyper_parameters"]
    del given["_instantiator"]
    assert settings.keys() == given.keys()
    assert settings["generator"]["init_args"] == given["generator"]["init_args"]
    assert settings["reconstruction"]["init_args"] == given["reconstruction"]["init_args"]
    assert settings["discriminator_optimizer"] == "normalgan.gan._rmsprop"
    assert settings["lr_scheduler"]["class_path"] == "torch.optim.lr_scheduler.CosineAnnealingLR"
    weights = checkpoint.weights(32)
    built = weights.generator().state_dict()
    saved = sound()["state_dict"]
    assert all(torch.equal(tensor, saved[f"generator.{name}"]) for name, tensor in built.items())
    assert weights.notes.generator.name == "UNetGenerator"


@pytest.mark.parametrize("kind", MODEL)
def test_a_model_that_would_do_harm_is_refused_by_all(here: Path, kind: str) -> None:
    edit, words = MODEL[kind]
    for training in (False, True):
        refused(save(here / "bad.ckpt", edit), words, training)


@pytest.mark.parametrize("kind", TRAINING)
def test_training_that_would_do_harm_is_refused_by_fit_and_ignored_by_others(here: Path, kind: str) -> None:
    edit, words = TRAINING[kind]
    path = save(here / "bad.ckpt", edit)
    refused(path, words, training=True)
    assert read_checkpoint(path).weights(32).generator()


@pytest.mark.parametrize("kind", RESUMED)
def test_no_run_is_resumed_with_what_no_run_saves(here: Path, kind: str) -> None:
    edit, name = RESUMED[kind]
    loops = sound()["loops"]["fit_loop"]
    read_checkpoint(save(here / "sound.ckpt")).check_progress(loops)
    path = save(here / "bad.ckpt", edit)
    with pytest.raises(InputError, match=f"no run can be resumed from .*bad.ckpt: its {name} is not what"):
        read_checkpoint(path).check_progress(loops)
    assert read_checkpoint(path).weights(32).generator()  # nobody else asks for it


@pytest.mark.parametrize("kind", IGNORED)
def test_what_nobody_asks_does_nothing(here: Path, kind: str) -> None:
    checkpoint = read_checkpoint(save(here / "odd.ckpt", IGNORED[kind]))
    assert checkpoint.training_settings()["generator"]["class_path"].endswith("UNetGenerator")
    assert checkpoint.weights(32).generator()


@pytest.mark.parametrize("kind", FILES)
def test_files_are_refused_before_they_are_loaded(here: Path, kind: str) -> None:
    make, words = FILES[kind]
    (here / "bad.ckpt").write_bytes(make())
    refused(here / "bad.ckpt", words, training=False)
