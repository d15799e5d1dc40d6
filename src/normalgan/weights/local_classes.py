"""Classes in the working directory that a weights file names, imported only if they are defined there."""

import ast
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from importlib import import_module
from importlib.util import find_spec
from inspect import isabstract
from pathlib import Path
from typing import TypeVar

from normalgan.errors import FOREIGN_ERRORS, InputError, brief
from normalgan.files.limits import MOST_SETTINGS, read_bounded

T = TypeVar("T")

_allowed: ContextVar[bool] = ContextVar("_allowed", default=True)


@contextmanager
def no_local_classes() -> Iterator[None]:
    """Disable imports from the working directory, so that only registered and imported classes are found."""
    token = _allowed.set(False)
    try:
        yield
    finally:
        _allowed.reset(token)


def find_local(name: str, base: type[T]) -> type[T] | None:
    """Return the class with a dotted path from a module in the working directory, or None.

    Python must search the working directory, as with ``python -m normalgan``. A weights file is data and
    may be untrusted, so a module is imported only if its source defines the class.

    Args:
        name: dotted path of the class, such as ``nets.OwnGenerator``.
        base: required base class.

    Raises:
        InputError: if importing the module fails.
    """
    module, _, cls_name = name.rpartition(".")
    if not _allowed.get() or not module or not all(part.isidentifier() for part in name.split(".")):
        return None
    here = Path.cwd()
    if not any(os.path.realpath(entry or ".") == os.path.realpath(here) for entry in sys.path):
        return None
    path = here.joinpath(*module.split("."))
    file = next((f for f in (path.with_suffix(".py"), path / "__init__.py") if f.is_file()), None)
    if file is None or not _defines(file, cls_name) or not _is_found_first(module.partition(".")[0], here):
        return None
    try:
        found = getattr(import_module(module), cls_name, None)
    except FOREIGN_ERRORS as error:  # the user's module may raise anything
        raise InputError(
            f"{file.name} cannot be imported: {type(error).__name__}: {brief(error)}."
        ) from error
    usable = isinstance(found, type) and issubclass(found, base) and not isabstract(found)
    return found if usable else None


def where_classes_are_looked_for(name: str) -> str:
    """Return advice on an unknown class, as a sentence after a space.

    >>> where_classes_are_looked_for("nets.OwnGenerator")
    ' Install the package that offers it, or run python -m normalgan in the folder of nets.'
    """
    module = name.rpartition(".")[0].partition(".")[0]
    install = " Install the package that offers it"
    return f"{install}, or run python -m normalgan in the folder of {module}." if module else f"{install}."


def _defines(file: Path, name: str) -> bool:
    try:
        tree = ast.parse(read_bounded(file, MOST_SETTINGS))
    except (OSError, InputError, SyntaxError, ValueError, RecursionError):
        return False
    return any(isinstance(node, ast.ClassDef) and node.name == name for node in tree.body)


def _is_found_first(package: str, here: Path) -> bool:
    """Return whether Python finds a top-level module in the working directory first."""
    try:
        spec = find_spec(package)
    except (ImportError, ValueError):
        return False
    places = [spec.origin, *(spec.submodule_search_locations or [])] if spec else []
    return any(place and Path(place).resolve().is_relative_to(here.resolve()) for place in places)
