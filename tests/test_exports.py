"""What a module offers is in its `__all__`; what is not begins with an underscore."""

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


def is_type_variable(node: ast.stmt) -> bool:
    call = getattr(node, "value", None)
    return isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "TypeVar"


def test_every_module_says_what_it_offers_and_hides_the_rest() -> None:
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
            elif not is_type_variable(node):
                defined |= set(assigned(node))
        public = {name for name in defined if not name.startswith("_")}
        name = str(path.relative_to(SOURCE))
        if offered is None:
            wrong[name] = "no __all__"
        elif len(set(offered)) != len(offered):
            wrong[name] = "names twice"
        elif missing := public - set(offered):
            wrong[name] = f"neither in __all__ nor private: {sorted(missing)}"
        elif (unknown := set(offered) - defined - imported) and name != "__init__.py":  # the lazy face
            wrong[name] = f"not defined: {sorted(unknown)}"
    assert not wrong


@pytest.mark.parametrize("name", ["normalgan", "normalgan.normals", "normalgan.rendering", "normalgan.hints"])
def test_what_is_offered_is_there(name: str) -> None:
    scope: dict[str, object] = {}
    exec(f"from {name} import *", scope)
    assert len(scope) > 1
