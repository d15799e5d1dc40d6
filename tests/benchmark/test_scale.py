import pytest

from normalgan.benchmark.scale import read_budget, read_scale
from normalgan.errors import InputError


@pytest.mark.parametrize("text", ["8", "m", "8 m", "-8m", "8m later", "", "8d"])
def test_an_invalid_budget_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"is not a duration; write it like 8m"):
        read_budget(text)


def test_a_budget_of_zero_is_refused() -> None:
    with pytest.raises(InputError, match="must be more than zero"):
        read_budget("0m")


@pytest.mark.parametrize("text", ["data.size", "model.n_critic=1", "size=64", "data=1"])
def test_only_data_and_trainer_are_set(text: str) -> None:
    with pytest.raises(InputError, match=r"write settings of data or trainer, like data\.size=64"):
        read_scale([], [text])


def test_a_value_that_is_not_yaml_is_refused() -> None:
    with pytest.raises(InputError, match="whose value is not YAML"):
        read_scale([], ["data.size=[1"])


def test_a_scale_is_named_after_its_overlays_and_tells_what_was_changed() -> None:
    scale = read_scale(
        ["configs/gpu.yaml", "configs/on_the_fly.yaml"],
        ["data.size=64", "data.cache=/fast", "data.meshes=a/*.off"],
    )
    assert scale.name == "gpu+on_the_fly"
    assert scale.changed == {"data.size": 64}  # where files lie changes no figure
    assert scale.given == {"data": {"size": 64, "cache": "/fast", "meshes": "a/*.off"}}
    assert read_scale([]).name == "published"
