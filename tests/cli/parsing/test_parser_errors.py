import pytest

from normalgan.cli.parsing.errors import explain
from normalgan.rendering.lines import LINE_DRAWINGS

LINES = {"styles": LINE_DRAWINGS}


@pytest.mark.parametrize(
    ("message", "sentence"),
    [
        (
            "Parser key \"sizes\" element 2:\n  Expected a <class 'int'>. Got value: wide",
            'argument "sizes", item 2: expected a whole number, not wide.',
        ),
        (
            'Parser key "lines":\n  Parser key "styles" element 3:\n'
            "    Expected a dot import path string: Silhouete",
            "argument \"lines.styles\", item 3: no LineDrawing named 'Silhouete'. Did you mean Silhouette?",
        ),
        (
            'Parser key "styles" element 1:\n  Not a valid subclass of LineDrawing. Got value: 3\n'
            "  Subclass types expect one of:\n  - a class path (str)",
            'argument "styles", item 1: 3 is not a LineDrawing; known: Brush, ',
        ),
        (
            'Parser key "others":\n  Not a valid subclass of LineDrawing. Got value: 3\n'
            "  Subclass types expect one of:\n  - a class path (str)",
            'argument "others": 3 is not a LineDrawing.',
        ),
        (
            'Parser key "others":\n  Expected a dot import path string: Silhouete',
            "argument \"others\": no class named 'Silhouete'.",
        ),
        (
            'Parser key "hand.strength":\n'
            "  Expected a <class 'list'>. Got value: NestedArg(key='strength', val='3')",
            'argument "hand.strength": expected a list, not 3.',
        ),
    ],
)
def test_a_wrong_item_of_a_list_is_one_sentence(message: str, sentence: str) -> None:
    said = explain(message, LINES)
    assert said.startswith(sentence)
    assert "\n" not in said
    assert "Parser key" not in said


@pytest.mark.parametrize(
    ("message", "sentence"),
    [
        ("unrecognized arguments: b.png", "unexpected argument b.png."),
        ("unrecognized arguments: my horse.obj", "unexpected argument my horse.obj."),
        ("argument --alpha: ignored explicit argument '3'", "--alpha takes no value, not 3."),
        (
            "argument shell: invalid choice: 'fish' (choose from 'bash', 'zsh')",
            "shell: expected one of 'bash', 'zsh', not fish.",
        ),
        ("argument -o/--output: expected one argument", "--output needs a value."),
        (
            "ambiguous option: --he could match --help, --height",
            "--he may be --help or --height; write the option in full.",
        ),
        ("the following arguments are required: map, output", "missing: map, --output."),
        (
            "Parser key \"hand.preview\":\n  - Expected a typing.Literal['png', 'gif']\n"
            "  - Expected a <class 'NoneType'>\n  Given value: jpg",
            "--hand.preview: expected one of 'png', 'gif', not jpg.",
        ),
    ],
)
def test_an_option_is_named_as_a_shell_spells_it(message: str, sentence: str) -> None:
    assert explain(message, {}, (), {"output": "--output", "hand": "--hand"}) == sentence
