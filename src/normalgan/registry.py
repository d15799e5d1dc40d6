"""Registry of plug-ins by class name: a decorator, entry points, and suggestions for typos.

jsonargparse itself finds imported subclasses by their short names, lists them in ``--help`` and checks
``init_args``.
"""

import inspect
import os
import sys
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from importlib.metadata import EntryPoint, EntryPoints, PackageNotFoundError, entry_points, version
from pkgutil import iter_modules
from types import FunctionType
from typing import Any, ClassVar, Generic, TypeVar, get_origin

from normalgan.errors import brief, did_you_mean

T = TypeVar("T")
C = TypeVar("C", bound=type[Any])


def offered(group: str) -> EntryPoints:
    """Return the entry points of installed packages in a group.

    Reading the entry points of a few hundred packages takes 0.1 s. All groups are therefore read together,
    and again only after `sys.path` or one of its folders has changed.
    """
    state = tuple((folder, _changed(folder)) for folder in sys.path)
    selected: EntryPoints = _all_offered(state).select(group=group)
    return selected


@lru_cache(maxsize=1)
def _all_offered(_state: tuple[tuple[str, int], ...]) -> Any:  # Python 3.11 returns another type
    return entry_points()


def _changed(folder: str) -> int:
    """Return the modification time (ns) of a folder on `sys.path`, or 0 if it does not exist."""
    try:
        return os.stat(folder or ".").st_mtime_ns  # noqa: PTH116 -- an entry may be empty or not be a path
    except OSError:
        return 0


@dataclass(frozen=True)
class LeftOut:
    """An installed plug-in that cannot be used.

    Args:
        entry: name of the entry point.
        value: class of the plug-in, as ``module:Class``.
        group: group of the entry point.
        package: name and version of the package; empty if unknown.
        reason: why the plug-in cannot be used, as a sentence without a full stop.
    """

    entry: str
    value: str
    group: str
    package: str
    reason: str

    def __str__(self) -> str:
        return f"the plug-in {self.entry!r} ({self.value}) of {self.group} is left out: {self.reason}"


class Registry(Generic[T]):
    """The known concrete subclasses of an abstract base class, by class name.

    Args:
        base: abstract base class of the plug-ins.
        group: entry-point group for plug-ins of other packages, such as ``normalgan.hint_samplers``.

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
        self.left_out: list[LeftOut] = []
        """Plug-ins that `discover` found but could not use."""
        self._classes: dict[str, type[T]] = {}
        self._packages: dict[str, str] = {}

    def register(self, cls: C) -> C:
        """Register a class under its own name; usable as a decorator.

        If a class of another package already has that name, settings can name the new class only by its
        full path. An error would make its module unusable, and users of both packages cannot rename the
        classes.

        Raises:
            TypeError: if ``cls`` is not a concrete subclass of the base, lacks an attribute that the base
                declares, or has a value where the base has a method.
            ValueError: if another class of the same package has the same name.
        """
        plugin: type[Any] = cls  # so that the checks do not narrow the return type
        if not inspect.isclass(plugin):
            raise TypeError(f"{getattr(cls, '__name__', cls)} is not a class.")
        name = plugin.__name__
        if not issubclass(plugin, self.base):
            raise TypeError(f"{name} is not a subclass of {self.base.__name__}.")
        if inspect.isabstract(plugin):
            missing = ", ".join(sorted(getattr(plugin, "__abstractmethods__", ())))
            raise TypeError(f"{name} is abstract: it does not implement {missing}.")
        _check_attributes(plugin, self.base)
        known = self._classes.get(name, plugin)
        if _defined_again(known, plugin):
            known = plugin
        self._classes[name] = known
        if known is not plugin and _package(known) == _package(plugin):
            raise ValueError(f"{_namesakes(known, plugin)}.")
        return cls

    def load_entry_points(self) -> None:
        """Import and register the plug-ins of installed packages; warn about those that cannot be used."""
        self.discover()
        with warnings.catch_warnings():
            # Even if warnings are errors, a broken plug-in must not stop commands that do not need it.
            warnings.simplefilter("always")
            for left in self.left_out:
                warnings.warn(str(left), stacklevel=2)

    def discover(self) -> None:
        """Import and register the plug-ins of installed packages; keep unusable ones in `left_out`."""
        self.left_out = []
        for entry in offered(self.group):
            reason = self._adopt(entry)
            if reason:
                self.left_out.append(LeftOut(entry.name, entry.value, self.group, offerer(entry), reason))

    def _adopt(self, entry: EntryPoint) -> str:
        """Import and register a class; return the reason if that fails."""
        try:
            cls = entry.load()
        except SystemExit:
            return "it ends the program while it is imported"
        except Exception as error:  # anything that a foreign package raises on import
            return f"{type(error).__name__}: {brief(error)}".rstrip(".")
        try:
            self.register(cls)
        except (TypeError, ValueError) as error:
            return brief(error).rstrip(".")
        if (known := self._classes[cls.__name__]) is not cls:
            return f"{_namesakes(known, cls)}, or name the second in full"
        self._packages[cls.__name__] = offerer(entry)
        return ""

    def package(self, name: str) -> str:
        """Return the package and version of a registered class, such as ``normalgan 0.1.0``."""
        if name not in self._packages:
            top = _package(self._classes[name])
            try:
                self._packages[name] = f"{top} {version(top)}"
            except PackageNotFoundError:
                self._packages[name] = top  # a module in the working directory
        return self._packages[name]

    def names(self) -> list[str]:
        """Return the registered class names in alphabetical order."""
        return sorted(self._classes)

    def find(self, name: str) -> type[T] | None:
        """Return the class that a file names, or None if it is unknown, without importing anything.

        Args:
            name: name or dotted path of a registered class. Only the package and the class name of a path
                are compared, because classes move within a package. An unregistered class is found if it
                is already imported.
        """
        known = self._registered(name)
        return known if known is not None or "." not in name else find_imported(name, self.base)

    def _registered(self, name: str) -> type[T] | None:
        short = name.rpartition(".")[2]
        if short not in self._classes:
            self.discover()
        known = self._classes.get(short)
        if known is None or "." not in name:
            return known
        return known if _package(known) == name.partition(".")[0] else None

    def __iter__(self) -> Iterator[type[T]]:
        return iter([self._classes[name] for name in self.names()])

    def explain_unknown(self, name: str) -> str:
        """Return the error message for an unregistered name, with the nearest registered one."""
        hint = did_you_mean(name, self.names(), 0.5)
        return f"no {self.base.__name__} named {name!r}.{hint} Known: {', '.join(self.names())}."


def _defined_again(known: type, plugin: type) -> bool:
    """Return whether a class redefines a known one, after a notebook cell or a failed import ran again."""
    same = (known.__module__, known.__qualname__) == (plugin.__module__, plugin.__qualname__)
    return same and not issubclass(plugin, known)


def _check_attributes(plugin: type, base: type) -> None:
    for name, annotation in inspect.get_annotations(base).items():
        origin: Any = get_origin(annotation)
        if origin is ClassVar and not hasattr(plugin, name):
            raise TypeError(f"{plugin.__name__} has no {name}, which every {base.__name__} has.")
    for name in dir(base):
        method = isinstance(inspect.getattr_static(base, name), (FunctionType, classmethod, staticmethod))
        if method and not name.startswith("__") and not callable(getattr(plugin, name)):
            kind = type(getattr(plugin, name)).__name__
            raise TypeError(f"{plugin.__name__}.{name} is a {kind}, but in {base.__name__} it is a method.")


def _package(cls: type) -> str:
    return cls.__module__.partition(".")[0]


def _namesakes(one: type, other: type) -> str:
    return f"two classes are named {one.__name__}: {one.__module__} and {other.__module__}; rename one"


def import_modules(package: str) -> None:
    """Import all modules of a package, so that a module with a plug-in need not be listed anywhere."""
    for found in iter_modules(sys.modules[package].__path__, f"{package}."):
        import_module(found.name)


def find_imported(name: str, base: type[T]) -> type[T] | None:
    """Return the concrete subclass of a base with a given dotted path, without importing anything.

    Only the package and the class name are compared, because packages re-export classes in other modules.

    >>> class Base: ...
    >>> class Dots(Base): ...
    >>> find_imported(f"{__name__.partition('.')[0]}.Dots", Base)
    <class '...Dots'>
    >>> find_imported("os.Dots", Base)
    """
    package, _, rest = name.partition(".")
    waiting, seen = [base], set()
    while waiting:
        for cls in type.__subclasses__(waiting.pop()):
            if cls in seen:
                continue
            seen.add(cls)
            waiting.append(cls)
            named = cls.__name__ == rest.rpartition(".")[2] and cls.__module__.partition(".")[0] == package
            if named and not inspect.isabstract(cls):
                return cls
    return None


def class_path(cls: type[Any]) -> str:
    """Return the dotted path that names a class in settings.

    >>> class_path(LeftOut)
    'normalgan.registry.LeftOut'
    """
    return f"{cls.__module__}.{cls.__qualname__}"


def summary(cls: type[Any]) -> str:
    """Return the first line of a class's own docstring, or "" if there is none.

    >>> summary(LeftOut)
    'An installed plug-in that cannot be used.'
    """
    doc = (cls.__dict__.get("__doc__") or "").strip()
    # A dataclass without a docstring gets its signature as the docstring.
    return "" if doc.startswith(f"{cls.__name__}(") else doc.partition("\n")[0].strip()


def offerer(entry: EntryPoint) -> str:
    """Return the name and version of an entry point's package, or "" if it is unknown."""
    return f"{entry.dist.name} {entry.dist.version}" if entry.dist else ""
