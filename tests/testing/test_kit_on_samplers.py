from typing import Any

import pytest
import torch
from broken_samplers import FAULTS, Right
from torch import Tensor

from normalgan.hints import HintSampler
from normalgan.testing import ConformanceError, check, checks


@pytest.mark.parametrize(("cls", "sentence"), FAULTS, ids=[cls.__name__ for cls, _ in FAULTS])
def test_a_fault_is_told_in_one_sentence(cls: type[HintSampler], sentence: str) -> None:
    with pytest.raises(ConformanceError, match=f"^{sentence}") as caught:
        check(cls())
    said = str(caught.value)
    assert "\n" not in said
    assert said.endswith(".")
    assert len(said) < 300


def test_a_class_in_place_of_its_object_is_told() -> None:
    given: Any = Right
    with pytest.raises(ConformanceError, match=r"^Right is a class; give an object of it, Right\(…\)\.$"):
        check(given)


def test_what_is_of_no_kind_is_told() -> None:
    with pytest.raises(ConformanceError, match=r"^int is not a kind of plug-in; .* one of .*, HintSampler, "):
        check(3)


def test_what_does_as_asked_passes() -> None:
    check(Right())


def test_a_class_inside_a_function_is_told_off() -> None:
    class Inner(Right):
        """Cannot be named."""

    with pytest.raises(
        ConformanceError, match=r"Inner cannot be imported as .*<locals>\.Inner; YAML and check"
    ):
        check(Inner())


@pytest.mark.parametrize("library", ["numpy", "torch"])
def test_each_global_random_state_is_watched(library: str, monkeypatch: pytest.MonkeyPatch) -> None:
    import numpy as np

    def sample(self: Right, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        np.random.rand() if library == "numpy" else torch.rand(1)  # noqa: NPY002
        return torch.zeros_like(mask)

    monkeypatch.setattr(Right, "sample", sample)
    with pytest.raises(ConformanceError, match=f"Right drew from or seeded {library}'s global random state"):
        check(Right())


def test_checks_have_names_of_their_own() -> None:
    names = [str(check) for check in checks(HintSampler)]
    assert len(set(names)) == len(names) > 10
    assert "hints on the object" in names


def test_a_failed_check_is_a_failed_assertion() -> None:
    assert issubclass(ConformanceError, AssertionError)
