"""What engines import a map by: the name of a map is data there, whatever it is."""

import ast
import json
import os
import re
from pathlib import Path
from typing import get_args

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from normalgan.inference.outputs.engines import Engine, sidecar

# What ends a string, a comment or a line somewhere, what is not UTF-8, and any other letter.
PARTS = ['"""', "'''", '"', "'", "\\", "\n", "\r", "\\n", "\\u0022", "{", "}", "<LITERAL>", "#", ": "]
PARTS += ["[deps]", "import os; os.system('true')", "\u2028", "\x85", "\x1b", "\udcff", "ü", "🐺"]
LETTERS = st.characters(exclude_categories=["Cs"], exclude_characters="/\0")
NAMES = st.lists(st.sampled_from(PARTS) | LETTERS, min_size=1, max_size=12).map("".join)
NAMES = NAMES.filter(lambda name: Path("/maps", name).name == name)  # a backslash is no letter on Windows


def text_of(content: bytes) -> str:
    return os.fsdecode(content)


def name_in(engine: Engine, text: str) -> str:
    """Return the name that an engine reads in its file, which is a sound one."""
    match engine:
        case "unity":
            assert re.fullmatch("[0-9a-f]{32}", str(yaml.load(text, yaml.BaseLoader)["guid"]))
            return ""
        case "godot" | "godot3":
            found = re.findall(r"(?m)^source_file=(.*)$", text)
            return str(json.loads(found[0])).removeprefix("res://")
        case _:
            compile(text, "script", "exec")
            found = [node.value for node in ast.parse(text).body if isinstance(node, ast.Assign)]
            return str(ast.literal_eval(found[0]))


@pytest.mark.parametrize("engine", get_args(Engine))
@settings(max_examples=40)
@given(name=NAMES)
def test_the_name_of_a_map_is_one_string_and_nothing_else(engine: Engine, name: str) -> None:
    path, content = sidecar(engine, Path("/maps", f"{name}.png"))
    assert path.name.startswith(f"{name}.png.")
    assert name_in(engine, text_of(content)) == ("" if engine == "unity" else f"{name}.png")
    lines, usual = (
        text_of(each).split("\n") for each in (content, sidecar(engine, Path("/maps/fox.png"))[1])
    )
    assert sum(a != b for a, b in zip(lines, usual, strict=True)) <= 1
