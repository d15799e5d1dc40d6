"""What a module offers begins without an underscore; packages list what they offer of their modules."""

import ast
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[1] / "src" / "normalgan"
FILES = sorted(SOURCE.rglob("*.py"))


def assigned(node: ast.stmt) -> list[str]:
    """Return the names that a statement gives values to."""
    targets: list[ast.expr] = []
    if isinstance(node, ast.AnnAssign) and node.value is not None:
        targets = [node.target]
    elif isinstance(node, ast.Assign):
        targets = node.targets
    flat = [
        each for target in targets for each in (target.elts if isinstance(target, ast.Tuple) else [target])
    ]
    return [each.id for each in flat if isinstance(each, ast.Name)]


def test_a_package_lists_what_it_offers_and_a_module_only_if_it_offers_what_it_imports() -> None:
    wrong: dict[str, object] = {}
    for path in FILES:
        offered: list[str] | None = None
        defined, imported = set(), set()
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            if isinstance(node, ast.Import | ast.ImportFrom):
                imported |= {(alias.asname or alias.name).partition(".")[0] for alias in node.names}
        for node in tree.body:
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                defined.add(node.name)
            elif "__all__" in assigned(node):
                offered = ast.literal_eval(node.value)  # type: ignore[attr-defined]
            else:
                defined |= set(assigned(node))
        public = {name for name in defined if not name.startswith("_")}
        name = str(path.relative_to(SOURCE))
        package = path.name == "__init__.py"
        if offered is None:
            wrong |= {name: "no __all__"} if package else {}
        elif len(set(offered)) != len(offered):
            wrong[name] = "names twice"
        elif missing := public - set(offered):
            wrong[name] = f"neither in __all__ nor private: {sorted(missing)}"
        elif (unknown := set(offered) - defined - imported) and name != "__init__.py":  # the lazy face
            wrong[name] = f"not defined: {sorted(unknown)}"
        elif not package and not set(offered) - defined:
            wrong[name] = "__all__ lists only what the module defines; drop it"
    assert not wrong


@pytest.mark.parametrize("name", ["normalgan", "normalgan.normals", "normalgan.rendering", "normalgan.hints"])
def test_what_is_offered_is_there(name: str) -> None:
    scope: dict[str, object] = {}
    exec(f"from {name} import *", scope)
    assert len(scope) > 1
