from functools import partial
from pathlib import Path

import pytest
import torch
import yaml

from normalgan.callbacks import StartFrom
from normalgan.errors import InputError
from normalgan.models import UNetGenerator
from normalgan.weights.file import read_weights
from normalgan.weights.shipped import SHIPPED
from small import QUIET, data, gan, trainer

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.filterwarnings(*QUIET)


@pytest.fixture(name="other")
def train_other(meshes: Path, cache: Path, tmp_path: Path) -> Path:
    run = trainer(tmp_path / "other", max_epochs=1)
    run.fit(gan(seed=1), data(meshes, cache))
    run.save_checkpoint(tmp_path / "other.ckpt")
    # From Python the settings are saved as objects, from the command line as text, which is safe to read.
    plain = torch.load(tmp_path / "other.ckpt", weights_only=False)
    plain["hyper_parameters"] = {part: {} for part in ("generator", "hint_sampler", "objective")}
    torch.save(plain, tmp_path / "other.ckpt")
    return tmp_path / "other.ckpt"


def test_a_new_run_begins_with_the_other_ones_generator(
    other: Path, meshes: Path, cache: Path, tmp_path: Path
) -> None:
    saved = torch.load(other, weights_only=True)["state_dict"]
    model = gan()
    discriminator = model.discriminator
    assert discriminator is not None
    before = {name: w.clone() for name, w in discriminator.state_dict().items()}
    trainer(tmp_path / "new", max_steps=0, callbacks=[StartFrom(str(other))]).fit(model, data(meshes, cache))
    for name, weights in model.generator.state_dict().items():
        assert torch.equal(weights, saved[f"generator.{name}"])
    for name, weights in discriminator.state_dict().items():
        assert torch.equal(weights, before[name])


def test_a_new_run_takes_the_other_ones_discriminator_too_with_other_rates(
    other: Path, meshes: Path, cache: Path, tmp_path: Path
) -> None:
    saved = torch.load(other, weights_only=True)["state_dict"]
    model = gan(generator_optimizer=partial(torch.optim.RMSprop, lr=1e-6))
    start = StartFrom(str(other), discriminator=True)
    run = trainer(tmp_path / "new", max_steps=0, callbacks=[start])
    run.fit(model, data(meshes, cache))
    assert model.discriminator is not None
    for name, weights in model.discriminator.state_dict().items():
        assert torch.equal(weights, saved[f"discriminator.{name}"])
    assert run.optimizers[0].param_groups[0]["lr"] == 1e-6
    with pytest.raises(InputError, match="holds a generator alone"):
        trainer(tmp_path / "b", max_steps=0, callbacks=[StartFrom("shipped", discriminator=True)]).fit(
            model, data(meshes, cache)
        )
    with pytest.raises(InputError, match="takes a file, not the address"):
        trainer(tmp_path / "c", max_steps=0, callbacks=[StartFrom("https://example.org/m.ckpt")]).fit(
            model, data(meshes, cache)
        )
    with pytest.raises(InputError, match="grow or discriminator, not both"):
        StartFrom(grow=True, discriminator=True)


def test_a_resumed_run_goes_on_with_its_own(other: Path, meshes: Path, cache: Path, tmp_path: Path) -> None:
    first, again = gan(), gan()
    run = trainer(tmp_path / "new", max_epochs=1, callbacks=[StartFrom(str(other))])
    run.fit(first, data(meshes, cache))
    run.save_checkpoint(tmp_path / "new.ckpt")
    resumed = trainer(tmp_path / "new", max_epochs=1, callbacks=[StartFrom("/gone.ckpt")])
    resumed.fit(again, data(meshes, cache), ckpt_path=tmp_path / "new.ckpt", weights_only=False)
    for name, weights in again.generator.state_dict().items():
        assert torch.equal(weights, first.generator.state_dict()[name])


def test_what_cannot_be_begun_with_is_refused(other: Path, meshes: Path, cache: Path, tmp_path: Path) -> None:
    wider = gan(generator=UNetGenerator(size=32, width=8))
    for start, said in (
        (str(other), "whose generator is another one"),
        ("shipped", "ours.onnx, whose generator is another one"),
        (
            "shipped",
            r"settings: model: {generator: {class_path: ResidualUNetGenerator, init_args: {widths: \[24",
        ),
        ("/gone.ckpt", "there is no model"),
        ("/gone.safetensors", "there is no model"),
    ):
        with pytest.raises(InputError, match=said):
            trainer(tmp_path / "new", callbacks=[StartFrom(start)]).fit(wider, data(meshes, cache))


def of_class(other: Path, **settings: object) -> Path:
    """Name the class and the settings of the generator in a checkpoint, as the command line saves them."""
    content = torch.load(other, weights_only=True)
    content["hyper_parameters"]["generator"] = settings
    torch.save(content, other)
    return other


def test_a_generator_of_another_class_with_weights_of_equal_shapes_is_refused(
    other: Path, meshes: Path, cache: Path, tmp_path: Path
) -> None:
    of_class(other, class_path="normalgan.models.TiledGenerator", init_args={"widths": [4]})
    run = trainer(tmp_path / "new", max_steps=0, callbacks=[StartFrom(str(other))])
    with pytest.raises(
        InputError, match=r"whose generator is another one .*class_path: normalgan\.models\.Til"
    ):
        run.fit(gan(), data(meshes, cache))


def test_settings_that_the_weights_were_not_trained_with_are_warned_about(
    other: Path, meshes: Path, cache: Path, tmp_path: Path
) -> None:
    # A class that lay elsewhere when it was trained is known by its name.
    of_class(other, class_path="gone.UNetGenerator", init_args={"size": 32, "width": 4, "dropout": 0.25})
    run = trainer(tmp_path / "new", max_steps=0, callbacks=[StartFrom(str(other))])
    with pytest.warns(UserWarning, match=r"was trained with dropout 0\.25 \(the run has 0\.5\)\.$"):
        run.fit(gan(), data(meshes, cache))


def test_configurations_that_go_on_from_the_shipped_weights_build_their_generator() -> None:
    notes = read_weights(SHIPPED).notes
    for name in ("tuned", "shipped"):
        content = yaml.safe_load((ROOT / "configs" / f"{name}.yaml").read_text(encoding="utf-8"))
        given = content["model"]["generator"]
        assert given["class_path"] == notes.generator.name
        assert content["data"]["size"] == notes.size
        for setting, value in given["init_args"].items():
            told = notes.generator.settings[setting]
            assert (list(told) if isinstance(value, list) else told) == value
