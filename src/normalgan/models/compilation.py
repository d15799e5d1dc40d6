"""torch.compile for a generator in training, without renaming its weights."""

from collections.abc import Callable
from typing import Literal, cast

import torch
from torch import Tensor

from normalgan.errors import InputError, did_you_mean
from normalgan.models.base import Generator
from normalgan.models.predictions import Predictions


def check_compile(compile: bool | str) -> bool | str:  # the name of the setting
    """Return the setting after checking that torch has such a backend.

    Raises:
        InputError: if torch has no such backend.
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

    The function is compiled instead of the module, because a compiled module renames its weights in
    checkpoints.

    Args:
        generator: generator to compile.
        backend: name of a torch.compile backend; True for the default.
    """
    name = backend if isinstance(backend, str) else "inductor"
    return cast("Callable[[Tensor], Predictions]", torch.compile(generator.predict, backend=name))
