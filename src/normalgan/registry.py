"""Plug-ins by class name: a decorator, entry points, and an answer to a typo.

jsonargparse already finds every imported subclass of an annotated base by its short name, lists the
choices in ``--help`` and checks ``init_args``. A registry adds the four things it does not do.
"""

import difflib
import inspect
import warnings
from collections.abc import Iterator
from importlib.metadata import entry_points
from typing import Any, Generic, TypeVar

T = TypeVar("T")
C = TypeVar("C", bound=type[Any])


class Registry(Generic[T]):
    """The known concrete subclasses of one abstract base, by class name.

    Args:
        base: the abstract base every plug-in of this kind derives from.
        group: the entry-point group other packages use, such as ``normalgan.hint_samplers``.

    Example:
        >>> class Base: ...
        >>> registry = Registry(Base, "example.group")
        >>> @registry.register
        ... class Dots(Base): ...
        >>> registry.names()
        ['Dots']
    """

    def __init__(self, base: type[T], group: str) -> None:
        self.base = base
        self.group = group
        self._classes: dict[str, type[T]] = {}

    def register(self, cls: C) -> C:
        """Add a class under its own name; usable as a decorator.

        Raises:
            TypeError: if it is not a concrete subclass of the base.
            ValueError: if another class already has the name.
        """
        plugin: type[Any] = cls  # so that the checks do not narrow the type that is returned
        name = plugin.__name__
        if not issubclass(plugin, self.base):
            raise TypeError(f"{name} is not a subclass of {self.base.__name__}.")
        if inspect.isabstract(plugin):
            missing = ", ".join(sorted(getattr(plugin, "__abstractmethods__", ())))
            raise TypeError(f"{name} is abstract: it does not implement {missing}.")
        known = self._classes.get(name)
        if known is not None and known is not plugin:
            raise ValueError(
                f"two classes are named {name}: {known.__module__} and {plugin.__module__}; rename one."
            )
        self._classes[name] = plugin
        return cls

    def load_entry_points(self) -> None:
        """Import and register what other installed packages offer.

        A plug-in that cannot be loaded is left out with a warning, so that it breaks nothing else.
        """
        for entry in entry_points(group=self.group):
            try:
                self.register(entry.load())
            except Exception as error:  # whatever a foreign package raises on import
                warnings.warn(
                    f"the plug-in {entry.name!r} ({entry.value}) of {self.group} is left out: "
                    f"{type(error).__name__}: {error}",
                    stacklevel=2,
                )

    def names(self) -> list[str]:
        """Return the registered class names in alphabetical order."""
        return sorted(self._classes)

    def __iter__(self) -> Iterator[type[T]]:
        return iter([self._classes[name] for name in self.names()])

    def explain_unknown(self, name: str) -> str:
        """Return the sentence for a name that is not registered, with the nearest one that is."""
        near = difflib.get_close_matches(name, self.names(), n=1, cutoff=0.5)
        hint = f" Did you mean {near[0]}?" if near else ""
        return f"no {self.base.__name__} named {name!r}.{hint} Known: {', '.join(self.names())}."
