"""A class that is named starts from its own defaults, whichever class stood there before."""

import inspect
import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import yaml

from normalgan.__main__ import main
from normalgan.cli.class_settings import OwnDefaultsParser, classes_first
from normalgan.cli.discovery import REGISTRIES, SETTINGS
from normalgan.cli.sketch import build_parser
from normalgan.rendering.lines import LineDrawing
from normalgan.rendering.strokes.stroke import Stroke

SHIPPED = str(Path(__file__).parents[2] / "configs" / "lines_varied.yaml")
ABSENT = inspect.Parameter.empty
WAYS = ("options", "file", "file over file", "object")


def defaults(cls: type[Any]) -> dict[str, Any]:
    return {n: p.default for n, p in inspect.signature(cls).parameters.items() if p.default is not ABSENT}


def changed(value: Any) -> Any:
    """Return another value of the same type, or ABSENT where none is easily found."""
    match value:
        case bool():
            return not value
        case int() | float():
            return value + 1
        case tuple() if all(isinstance(part, int | float) for part in value):
            return tuple(part + 1 for part in value)
    return ABSENT


def pairs() -> Iterator[Any]:
    for kind in SETTINGS:
        registry = REGISTRIES[kind]
        ways = itertools.cycle(WAYS)  # each pair in one way, each kind in all of them
        for former, named in itertools.permutations(registry, 2):
            if defaults(former).keys() & defaults(named).keys():
                way = next(ways)
                name = f"{kind}: {former.__name__} to {named.__name__} by {way}"
                yield pytest.param(registry.base, former, named, way, id=name)


def required(cls: type[Any]) -> dict[str, Any]:
    """Return something for each setting that has no default."""
    parameters = inspect.signature(cls).parameters.values()
    needed = [p for p in parameters if p.default is p.empty and p.kind is p.POSITIONAL_OR_KEYWORD]
    return {p.name: 5.0 if p.annotation in {float, "float"} else "x" for p in needed}


@pytest.mark.parametrize(("base", "former", "named", "way"), list(pairs()))
def test_every_class_has_its_own_defaults(
    base: type[Any], former: type[Any], named: type[Any], way: str, tmp_path: Path
) -> None:
    """After another class, given by default or with every setting they share changed."""
    shared = {n: changed(v) for n, v in defaults(former).items() if n in defaults(named)}
    given = {n: list(v) if isinstance(v, tuple) else v for n, v in shared.items() if v is not ABSENT}
    parser = OwnDefaultsParser(exit_on_error=False)
    parser.add_argument("--config", action="config")
    parser.add_argument("--part", type=base)
    parser.set_defaults({"part": {"class_path": f"{former.__module__}.{former.__qualname__}"}})
    files = [tmp_path / "former.yaml", tmp_path / "named.yaml"]
    before = {"class_path": former.__name__, "init_args": given | required(former)}
    after = {"class_path": named.__name__, "init_args": required(named)}
    files[0].write_text(yaml.safe_dump({"part": before}))
    files[1].write_text(yaml.safe_dump({"part": after}))
    match way:
        case "options":
            options = [f"--part.{name}={value}" for name, value in given.items()]
            more = [f"--part.{name}={value}" for name, value in required(named).items()]
            parsed = parser.parse_args(
                [f"--part={former.__name__}", *options, f"--part={named.__name__}", *more]
            )
        case "file":
            parsed = parser.parse_args(["--config", str(files[1])])
        case "file over file":
            parsed = parser.parse_args([text for file in files for text in ("--config", str(file))])
        case _:
            parsed = parser.parse_object({"part": after})
    wanted = defaults(named)
    found = parsed.part.init_args.as_dict()
    plain = {n: v for n, v in wanted.items() if isinstance(v, bool | int | float | str | tuple | None)}
    assert {n: tuple(found[n]) if isinstance(found[n], list) else found[n] for n in plain} == plain


def test_settings_without_a_class_change_the_class_that_is_there() -> None:
    parsed = build_parser().parse_args(
        ["horse", "--lines", "Brush", "--lines.line_width", "3", "--lines", "Brush"]
    )
    assert parsed.lines.init_args.line_width == 3
    parsed = build_parser().parse_args(["horse", "--lines.line_width", "3"])
    assert parsed.lines.class_path.endswith("SuggestiveContours")
    assert parsed.lines.init_args.line_width == 3


def test_settings_may_stand_before_their_class() -> None:
    parsed = build_parser().parse_args(["--lines.line_width", "3", "horse", "--lines", "Brush"])
    assert parsed.mesh == "horse"
    assert parsed.lines.class_path.endswith("Brush")
    assert parsed.lines.init_args.line_width == 3


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        ("--a.x 1 --a.y 2 --b 3 --a C", "--b 3 --a C --a.x 1 --a.y 2"),
        ("--a.x=1 --a=C", "--a=C --a.x=1"),
        ("--a.b.x 1 --a.b C --a D", "--a D --a.b C --a.b.x 1"),
        ("--a C --a.x 1 --a D", "--a C --a.x 1 --a D"),  # the setting was C's
        ("--a.x 1 --config f --a C", "--a.x 1 --config f --a C"),  # files win over what stands before them
        ("--a.x 1 --a f.yaml", "--a.x 1 --a f.yaml"),
        ("fit -v --ab.x 1 --a C", "fit -v --ab.x 1 --a C"),
        ("", ""),
    ],
)
def test_classes_come_before_their_settings(given: str, wanted: str) -> None:
    assert classes_first(given.split()) == wanted.split()


@dataclass(frozen=True)
class Gaps(LineDrawing):
    """A third party's style.

    Args:
        line_width: pixels.
        strength: of its own meaning.
    """

    line_width: float = 7.5
    strength: float = 3.0

    def trace(self, view: Any, rng: Any) -> list[Stroke]:
        """Return nothing."""
        return []


@pytest.mark.parametrize("way", ["option", "file"])
def test_fit_gives_a_third_partys_style_its_own_settings(
    way: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    named = f"{Gaps.__module__}.{Gaps.__name__}"
    file = tmp_path / "a.yaml"
    file.write_text(yaml.safe_dump({"data": {"lines": {"class_path": named}}}))
    arguments = ["--data.lines", named] if way == "option" else ["--config", str(file)]
    assert main(["fit", "--config", SHIPPED, *arguments, "--print_config"]) == 0
    lines = yaml.safe_load(capsys.readouterr().out)["data"]["lines"]
    assert lines["init_args"] == {"line_width": 7.5, "strength": 3.0}


def test_sketch_draws_a_brush_with_its_own_width(tmp_path: Path) -> None:
    drawn = [tmp_path / "named.svg", tmp_path / "spelt.svg"]
    for path, width in zip(drawn, ([], ["--lines.line_width", "2.0"]), strict=True):
        assert main(["sketch", "horse-7", "-o", str(path), "--size", "96", "--lines", "Brush", *width]) == 0
    assert drawn[0].read_text() == drawn[1].read_text()
