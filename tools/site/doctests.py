"""Extension for the reference pages: shows examples in docstrings as code instead of quotations."""

import re

import griffe

EXAMPLE = re.compile(r"(?:^>>> .*\n?(?:^(?!\s*$).*\n?)*)", re.M)


class Doctests(griffe.Extension):
    """Puts code fences around doctests in running text."""

    def on_object(self, *, obj: griffe.Object, **_: object) -> None:
        """Fence the examples of a docstring, and give their sections the name that griffe expects."""
        if obj.docstring:
            text = re.sub(r"^Example:$", "Examples:", obj.docstring.value, flags=re.M)
            obj.docstring.value = EXAMPLE.sub(fenced, text)


def fenced(found: re.Match[str]) -> str:
    """Return an example up to the next empty line as a fenced block."""
    return f"```pycon\n{found[0].rstrip()}\n```\n"
