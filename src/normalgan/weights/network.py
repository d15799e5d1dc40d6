"""Build a generator that fits given tensors, after checking them."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TypeVar

import torch
from torch import Tensor, nn
from torch.nn.modules.module import register_module_parameter_registration_hook

from normalgan.errors import InputError
from normalgan.models import GENERATORS, Generator
from normalgan.registry import Registry
from normalgan.weights.class_spec import ClassSpec

Tensors = Mapping[str, Tensor]
T = TypeVar("T", bound=nn.Module)
_FLOATS = {torch.float16, torch.bfloat16, torch.float32, torch.float64}


def check_fit(part: ClassSpec, tensors: Tensors, registry: Registry[T], finite: bool = True) -> None:
    """Check that tensors are the weights of a network, without allocating memory.

    Args:
        part: class and settings of the network.
        tensors: tensors by name.
        registry: registry of the network's base class.
        finite: whether all values must be finite.

    Raises:
        InputError: if the network cannot be built, or the tensors do not fit it or are not finite.
    """
    # On the meta device and limited to the number of tensors, because settings may ask for billions of
    # layers.
    with torch.device("meta"), _at_most(2 * len(tensors) + 16):
        wanted = part.build(registry).state_dict()
    for name in [*wanted, *tensors]:
        if name not in wanted or name not in tensors or not _alike(tensors[name], wanted[name]):
            raise InputError(
                f"its weights are not those of a {part.name} with these settings: {name[:80]} is "
                f"{_shape(tensors, name)}, not {_shape(wanted, name)}."
            )
    for name, tensor in tensors.items() if finite else ():
        if tensor.is_floating_point() and not tensor.isfinite().all():
            raise InputError(f"its weights {name[:80]} are not all finite numbers.")


def build_generator(part: ClassSpec, tensors: Tensors) -> Generator:
    """Return a generator with the given weights, in float32 and evaluation mode."""
    generator = part.build(GENERATORS)
    generator.load_state_dict(dict(tensors))
    return generator.eval()


@contextmanager
def naming_model(place: object) -> Iterator[None]:
    """Add the file to errors about building its model."""
    try:
        yield
    except InputError as error:
        raise InputError(f"the model in {place} cannot be built here: {error}") from error


@contextmanager
def _at_most(parameters: int) -> Iterator[None]:
    """Refuse to build a network with too many parameters."""
    seen = 0

    def count(module: nn.Module, name: str, parameter: nn.Parameter) -> None:
        nonlocal seen
        seen += parameter is not None
        if seen > parameters:
            raise InputError("it would have more weights than there are.")

    hook = register_module_parameter_registration_hook(count)
    try:
        yield
    finally:
        hook.remove()


def _alike(tensor: Tensor, wanted: Tensor) -> bool:
    kind = tensor.dtype in _FLOATS if wanted.is_floating_point() else tensor.dtype == wanted.dtype
    return kind and tensor.shape == wanted.shape


def _shape(tensors: Tensors, name: str) -> str:
    if name not in tensors:
        return "missing"
    dtype = str(tensors[name].dtype).removeprefix("torch.")
    return f"{dtype} {' × '.join(map(str, tensors[name].shape))}".rstrip()
