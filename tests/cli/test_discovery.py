import json
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from normalgan.__main__ import main
from normalgan.hints import HINT_SAMPLERS, HintSampler, UniformHints
from plugin_packages import install

SAMPLER = '''
from normalgan.hints import HintSampler
class {name}(HintSampler):
    """{summary}"""
    def sample(self, normal, mask, rng):
        return mask * 0
'''
GROUP = "normalgan.hint_samplers"
BROKEN = {
    "unknown_import": ("import no_such_library", "ModuleNotFoundError: No module named 'no_such_library'"),
    "bad_syntax": ("def (:", "SyntaxError: invalid syntax (bad_syntax.py, line 1)"),
    "leaves": ("import sys; sys.exit(3)", "it ends the program while it is imported"),
    "warns": (
        "import warnings\nwith warnings.catch_warnings():\n"
        "    warnings.simplefilter('error')\n    warnings.warn('old', DeprecationWarning)",
        "DeprecationWarning: old",
    ),
    "lacks_it": ("", "AttributeError: module 'lacks_it' has no attribute 'Dots'"),
    "function": ("def Dots(): ...", "Dots is not a class"),
    "stranger": ("class Dots: ...", "Dots is not a subclass of HintSampler"),
    "abstract": (
        "from normalgan.hints import HintSampler\nclass Dots(HintSampler): ...",
        "Dots is abstract: it does not implement sample",
    ),
    "namesake": (
        SAMPLER.format(name="UniformHints", summary="Another.") + "Dots = UniformHints",
        "two classes are named UniformHints: normalgan.hints.uniform and namesake; rename one, or name the "
        "second in full",
    ),
}


@pytest.mark.parametrize("module", BROKEN)
def test_a_broken_plugin_is_left_out_and_the_rest_goes_on(module: str, site: Path) -> None:
    source, reason = BROKEN[module]
    good = SAMPLER.format(name="GoodHints", summary="Give good ones.")
    install(
        site,
        "foreign",
        {module: source, "good_one": good},
        {GROUP: {"Aa": f"{module}:Dots", "Good": "good_one:GoodHints"}},
    )
    ours = {each for each in HINT_SAMPLERS.names() if HINT_SAMPLERS.package(each).startswith("normalgan ")}
    HINT_SAMPLERS.discover()
    (left,) = HINT_SAMPLERS.left_out
    assert (left.entry, left.value, left.package) == ("Aa", f"{module}:Dots", "foreign 1.5")
    assert left.reason == reason
    assert set(HINT_SAMPLERS.names()) == {"GoodHints", *ours} > {"NoHints", "UniformHints"}
    assert HINT_SAMPLERS.package("GoodHints") == "foreign 1.5"
    assert HINT_SAMPLERS.package("NoHints").startswith("normalgan ")


def test_a_package_that_is_installed_later_is_found(site: Path) -> None:
    HINT_SAMPLERS.discover()
    assert "LateHints" not in HINT_SAMPLERS.names()
    late = SAMPLER.format(name="LateHints", summary="Came later.")
    install(site, "foreign", {"late": late}, {GROUP: {"LateHints": "late:LateHints"}})
    HINT_SAMPLERS.discover()
    assert "LateHints" in HINT_SAMPLERS.names()


def test_a_broken_plugin_is_a_warning_even_where_warnings_are_errors(site: Path) -> None:
    install(
        site, "foreign", {"first": "1 / 0", "second": "[][0]"}, {GROUP: {"A": "first:A", "B": "second:B"}}
    )
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("error")
        HINT_SAMPLERS.load_entry_points()
    assert [str(each.message).partition(" is left out: ")[::2] for each in said] == [
        ("the plug-in 'A' (first:A) of normalgan.hint_samplers", "ZeroDivisionError: division by zero"),
        ("the plug-in 'B' (second:B) of normalgan.hint_samplers", "IndexError: list index out of range"),
    ]


def test_two_classes_of_one_name_need_the_dotted_path(site: Path) -> None:
    install(
        site,
        "foreign",
        {"twins": SAMPLER.format(name="UniformHints", summary="Another.")},
        {GROUP: {"UniformHints": "twins:UniformHints"}},
    )
    from jsonargparse import ArgumentError, ArgumentParser

    HINT_SAMPLERS.discover()
    parser = ArgumentParser(exit_on_error=False)
    parser.add_argument("--sampler", type=HintSampler)
    both = r"full class path .*normalgan\.hints\.UniformHints.*twins\.UniformHints"
    with pytest.raises(ArgumentError, match=both):
        parser.parse_args(["--sampler=UniformHints"])
    named = ["--sampler=normalgan.hints.UniformHints", "--sampler.minimum=3"]
    assert parser.instantiate(parser.parse_args(named)).sampler == UniformHints(3)


def test_the_command_tells_names_summaries_packages_and_reasons(
    site: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    modules = {
        "good": SAMPLER.format(name="Dots", summary="Give dots.\n\n    More of it.\n    "),
        "mute": "from dataclasses import dataclass\n"
        + SAMPLER.format(name="Mute", summary="").replace("class", "@dataclass\nclass", 1),
        "bad": "import no_such_library",
    }
    points = {"Dots": "good:Dots", "Mute": "mute:Mute", "Bad": "bad:Bad"}
    install(site, "foreign", modules, {GROUP: points, "normalgan.hint_sampler": {"Lost": "good:Dots"}})
    assert main(["plugins", "--kind", "hint_sampler"]) == 0
    said = capsys.readouterr()
    lines = [" ".join(line.split()) for line in said.out.splitlines()]
    assert lines[0] == "hint_sampler (--model.hint_sampler NAME)"
    assert "Dots foreign 1.5 Give dots." in lines
    assert "Mute foreign 1.5" in lines
    assert "Bad (bad:Bad, foreign 1.5): ModuleNotFoundError: No module named 'no_such_library'." in lines
    assert any(
        line.startswith("Lost") and line.endswith("Did you mean normalgan.hint_samplers?") for line in lines
    )
    assert "UNetGenerator" not in said.out
    assert said.err == ""
    assert main(["plugins", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    kinds = {each["kind"] for each in listed["plugins"]}
    assert kinds >= {"renderer", "lines", "hint_sampler", "generator", "discriminator", "objective"}
    (dots,) = [each for each in listed["plugins"] if each["name"] == "Dots"]
    assert dots == {
        "kind": "hint_sampler",
        "name": "Dots",
        "setting": "model.hint_sampler",
        "class_path": "good.Dots",
        "package": "foreign 1.5",
        "summary": "Give dots.",
    }
    assert [each["name"] for each in listed["left_out"]] == ["Bad", "Lost"]


@pytest.mark.parametrize(
    ("arguments", "answer"),
    [
        (["--kind", "hint_samplr"], "--kind: expected one of 'renderer', 'lines', 'hint_sampler'"),
        (["--knd", "lines"], "there is no option --knd. Did you mean --kind?"),
    ],
)
def test_a_mistake_is_one_sentence(
    arguments: list[str], answer: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plugins", *arguments]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"normalgan: {answer}")
    assert said.count("\n") == 1


@pytest.mark.slow  # imports torch in a process of its own
def test_the_list_needs_no_lightning() -> None:
    code = (
        "import sys; from normalgan.__main__ import main; main(['plugins']);"
        "print(sorted({'torch', 'lightning', 'kornia', 'torchmetrics'} & set(sys.modules)), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "torch" in done.stderr
    assert "lightning" not in done.stderr
