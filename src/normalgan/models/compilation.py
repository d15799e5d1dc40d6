"""torch.compile for a generator in training: the names of its weights stay as they are."""

from collections.abc import Callable
from typing import Literal, cast

import torch
from torch import Tensor

from normalgan.errors import InputError, did_you_mean
from normalgan.models.base import Generator
from normalgan.models.predictions import Predictions

__all__ = ["check_compile", "compiled_predict"]


def check_compile(compile: bool | str) -> bool | str:  # the name of the setting
    """Return the setting, if torch has such a backend.

    Raises:
        InputError: if it has none.
    """
    if isinstance(compile, str):
        known = torch.compiler.list_backends(exclude_tags=())
        if compile not in known:
            hint = did_you_mean(compile, known)
            raise InputError(
                f"compile is true, false or a backend of torch.compile, not {compile!r}.{hint} "
                f"Known: {', '.join(known)}."
            )
    return compile


def compiled_predict(generator: Generator, backend: Literal[True] | str) -> Callable[[Tensor], Predictions]:
    """Return the generator's ``predict``, compiled.

    A function is compiled, not the module: a compiled module renames its weights in checkpoints.

    Args:
        generator: predicts.
        backend: name of one of torch's; True for the default.
    """
    name = backend if isinstance(backend, str) else "inductor"
    return cast("Callable[[Tensor], Predictions]", torch.compile(generator.predict, backend=name))
