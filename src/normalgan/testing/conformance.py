"""Checks as named objects; each failure is reported in one sentence."""

import inspect
import pickle
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
import torch

from normalgan.contracts import class_name
from normalgan.errors import FOREIGN_ERRORS, InputError, brief

T = TypeVar("T")


class ConformanceError(AssertionError):
    """Error for a plug-in that breaks the contract of its base class; the message is one sentence."""


@dataclass(frozen=True)
class Check(Generic[T]):
    """One check of a plug-in; call it with the plug-in.

    Args:
        name: subject of the check in a few words, used as the test id in pytest.
        ask: function that raises `ConformanceError` if the plug-in breaks the contract.
        contract: requirement on the plug-in, for the message if it raises an exception.
    """

    name: str
    ask: Callable[[T], None]
    contract: str

    def __str__(self) -> str:
        return self.name

    def __call__(self, plugin: T) -> None:
        """Run the check on a plug-in.

        Raises:
            ConformanceError: if the plug-in breaks the contract or raises an exception.
        """
        if isinstance(plugin, type):
            raise ConformanceError(
                f"{plugin.__name__} is a class; give an object of it, {plugin.__name__}(…)."
            )
        try:
            self.ask(plugin)
        except ConformanceError:
            raise
        except FOREIGN_ERRORS as error:  # a third-party class may raise anything
            raise ConformanceError(
                f"{class_name(plugin)} raised {type(error).__name__} ({brief(error).rstrip('.')}) when asked "
                f"for {self.name}; {self.contract}."
            ) from error


def demand(fulfilled: object, plugin: object, did: str, asked: str) -> None:
    """Check a condition.

    Raises:
        ConformanceError: with the message ``<Class> <did>; <asked>.`` if the condition is false.
    """
    if not fulfilled:
        raise ConformanceError(f"{class_name(plugin)} {did}; {asked}.")


@contextmanager
def held_to_contract() -> Iterator[None]:
    """Convert the errors of run-time checks to conformance errors.

    Raises:
        ConformanceError: with the message of the run-time check.
    """
    try:
        yield
    except InputError as error:
        raise ConformanceError(str(error)) from error


def promised(method: Callable[..., object]) -> str:
    """Return the first docstring line of a base class's method, as part of a sentence.

    >>> from normalgan.hints import HintSampler
    >>> promised(HintSampler.sample)
    'sample must return the hint mask, (N, 1, H, W): 1 at a hinted pixel, 0 elsewhere'
    """
    line = (inspect.getdoc(method) or "").partition("\n")[0].replace("`", "").rstrip(".")
    return f"{method.__name__} must {line[0].lower()}{line[1:]}"


@contextmanager
def global_randomness_untouched(plugin: object) -> Iterator[None]:
    """Check that the global random states of Python, NumPy and torch do not change.

    Raises:
        ConformanceError: if code in the block drew from or seeded one of them.
    """
    kept = random.getstate(), np.random.get_state(), torch.get_rng_state()  # noqa: NPY002
    # From unpredictable states, so that seeding in the plug-in always changes them.
    random.seed()
    np.random.seed()  # noqa: NPY002
    torch.seed()
    before = _global_states()
    try:
        yield
        after = _global_states()
    finally:
        random.setstate(kept[0])
        np.random.set_state(kept[1])  # noqa: NPY002
        torch.set_rng_state(kept[2])
    for library, state in after.items():
        demand(
            state == before[library],
            plugin,
            f"drew from or seeded {library}'s global random state",
            "all randomness must come from the given generator, so that a resumed run is reproducible",
        )


def _global_states() -> dict[str, bytes]:
    states = {"Python": random.getstate(), "numpy": np.random.get_state()}  # noqa: NPY002
    return {name: pickle.dumps(state) for name, state in states.items()} | {
        "torch": torch.get_rng_state().numpy().tobytes()
    }


def seed_checks(run: Callable[[T, int], Sequence[Any]], source: str) -> list[Check[T]]:
    """Return the checks that the output of a plug-in depends only on the seed.

    Args:
        run: function that runs the plug-in with a seed and returns tensors or arrays.
        source: required source of random numbers, such as ``rng``.
    """

    def repeats(plugin: T) -> None:
        first = run(plugin, 4)
        torch.rand(3)  # a different global random state
        np.random.rand(3)  # noqa: NPY002
        again = run(plugin, 4)
        same = len(first) == len(again) and all(
            np.array_equal(np.asarray(one), np.asarray(other))
            for one, other in zip(first, again, strict=True)
        )
        asked = f"all randomness must come from {source}, so that a resumed run is reproducible"
        demand(same, plugin, "returned another output for the same seed", asked)

    def leaves_global(plugin: T) -> None:
        with global_randomness_untouched(plugin):
            run(plugin, 0)

    return [
        Check("the same output for the same seed", repeats, f"the output may depend only on {source}"),
        Check("no use of global randomness", leaves_global, f"all randomness comes from {source}"),
    ]


def untouched_check(run: Callable[[T, Any], object], given: Callable[[], Any]) -> Check[T]:
    """Return the check that a plug-in does not change its arguments.

    Args:
        run: function that runs the plug-in.
        given: function that creates the arguments: tensors or a batch.
    """

    def leaves(plugin: T) -> None:
        # Created twice, because `given` always creates the same arguments.
        arguments, kept = given(), given()
        run(plugin, arguments)
        same = all(map(torch.equal, _tensors(arguments), _tensors(kept)))
        demand(same, plugin, "changed the tensors it was given", "they belong to the caller; copy them")

    return Check("unchanged arguments", leaves, "they belong to the caller")


def _tensors(given: Mapping[str, Any] | Sequence[Any]) -> list[torch.Tensor]:
    parts = given.values() if isinstance(given, Mapping) else given
    return [part for part in parts if isinstance(part, torch.Tensor)]


def device_check(run: Callable[[T, torch.device], Sequence[torch.Tensor]]) -> Check[T]:
    """Return the check that a plug-in works on all available devices.

    Args:
        run: function that runs the plug-in with inputs on a device and returns its outputs.
    """

    def stays(plugin: T) -> None:
        for device in device_list():
            for output in run(plugin, device):
                did = f"returned a tensor on {output.device} for inputs on {device}"
                demand(output.device == device, plugin, did, "it must stay on the device of its input")

    return Check("all available devices", stays, "tensors must be created on the device of the input")


def device_list() -> list[torch.device]:
    """Return the available devices: the CPU and the first GPU."""
    return [torch.device("cpu"), *([torch.device("cuda", 0)] if torch.cuda.is_available() else [])]
