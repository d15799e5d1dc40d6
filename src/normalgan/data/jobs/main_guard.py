"""Main guard: whether a script can start processes that import it again."""

import ast
import inspect
import sys
from pathlib import Path

from normalgan.errors import InputError

__all__ = ["check_main_guard"]


def check_main_guard() -> None:
    """Check that the script which calls this does so under ``if __name__ == "__main__":``.

    A spawned process imports the script again. Without the guard it starts processes in turn, and dies.

    Raises:
        InputError: if it does not; it names the script and its line.
    """
    main = sys.modules.get("__main__")
    frame = inspect.currentframe()
    while frame is not None:
        again = frame.f_globals.get("__name__") == "__mp_main__"  # how a spawned process imports it
        if frame.f_code.co_name == "<module>" and (again or frame.f_globals is vars(main or sys)):
            script = frame.f_globals.get("__file__")  # none of an interactive session, which is not imported
            if script is not None and (again or not _is_guarded(Path(script), frame.f_lineno)):
                raise InputError(
                    f"line {frame.f_lineno} of {script} starts processes, which import this script again; "
                    'put the lines that do something under `if __name__ == "__main__":`.'
                )
        frame = frame.f_back


def _is_guarded(script: Path, line: int) -> bool:
    """Return whether a line of a script lies in an ``if`` that looks at the module's name or its parent."""
    try:
        tree = ast.parse(script.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return True  # no source in Python, such as a program that was frozen
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and node.lineno <= line <= (node.end_lineno or node.lineno):
            names = {each.id for each in ast.walk(node.test) if isinstance(each, ast.Name)}
            names |= {each.attr for each in ast.walk(node.test) if isinstance(each, ast.Attribute)}
            if names & {"__name__", "parent_process", "current_process"}:
                return True
    return False
