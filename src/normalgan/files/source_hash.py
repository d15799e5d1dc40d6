"""A hash of a third-party class's code, so that samples from an earlier version are not reused."""

import ast
import hashlib
import inspect
import sys
from contextlib import suppress
from functools import lru_cache
from importlib.util import resolve_name
from pathlib import Path

_NOT_THEIRS = frozenset({"normalgan", *sys.stdlib_module_names})


@lru_cache(maxsize=256)
def source_hash(kind: type) -> str:
    """Return a hash of the code of a third-party class and its bases, or "" for a class of this package.

    It covers the files of their modules, and the modules that these import from the same package, or from
    the same folder unless that is site-packages. For a class from the running script or an interactive
    prompt, it covers only the class itself.
    """
    code = []
    for base in kind.__mro__:
        module = base.__module__
        if module != "__main__" and module.partition(".")[0] in _NOT_THEIRS:
            continue
        file = getattr(sys.modules.get(module), "__file__", None)
        if module != "__main__" and file is not None and Path(file).is_file():
            code += [path.read_bytes() for path in _with_imports(module, Path(file))]
        else:
            with suppress(OSError, TypeError):  # defined at an interactive prompt
                code.append(inspect.getsource(base).encode())
    return hashlib.sha256(b"\0".join(code)).hexdigest()[:16] if code else ""


def _with_imports(module: str, file: Path) -> list[Path]:
    """Return the files of a module and of its direct and indirect imports."""
    root = file.parents[module.count(".") + (file.stem == "__init__")]
    theirs = {module.partition(".")[0]} if root.name in {"site-packages", "dist-packages"} else None
    found, waiting = {module: file}, [module]
    while waiting:
        name = waiting.pop()
        for imported in _imported(found[name], name):
            top = imported.partition(".")[0]
            if imported in found or top in _NOT_THEIRS or (theirs and top not in theirs):
                continue
            path = root.joinpath(*imported.split("."))
            for place in (path.with_suffix(".py"), path / "__init__.py"):
                if place.is_file():
                    found[imported] = place
                    waiting.append(imported)
    return [found[name] for name in sorted(found)]


def _imported(file: Path, module: str) -> set[str]:
    """Return the modules that a file imports, and the names imported from them, which may be modules too."""
    package = module if file.stem == "__init__" else module.rpartition(".")[0]
    names: set[str] = set()
    try:
        tree = ast.parse(file.read_bytes())
    except (SyntaxError, ValueError):  # for another version of Python, imported within a try
        return names
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            start = resolve_name("." * node.level + (node.module or ""), package)
            names |= {start, *(f"{start}.{alias.name}" for alias in node.names)}
    return names
