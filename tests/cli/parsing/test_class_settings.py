"""A class that is named starts from its own defaults, not from another's."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import yaml

from normalgan.__main__ import main
from normalgan.cli.parsing.light_parser import OwnDefaultsParser
from normalgan.cli.sketch import build_parser
from normalgan.rendering.lines import LineDrawing
from normalgan.rendering.strokes.stroke import Stroke


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


GAPS = f"{Gaps.__module__}.{Gaps.__name__}"


@pytest.mark.parametrize("way", ["option", "file", "object"])
def test_the_default_class_passes_none_of_its_defaults_on(way: str, tmp_path: Path) -> None:
    parser = OwnDefaultsParser(exit_on_error=False)
    parser.add_argument("--config", action="config")
    parser.add_argument("--lines", type=LineDrawing)
    parser.set_defaults({"lines": {"class_path": "SuggestiveContours", "init_args": {"interior_width": 1.2}}})
    settings = {"lines": {"class_path": GAPS}}
    file = tmp_path / "a.yaml"
    file.write_text(yaml.safe_dump(settings))
    if way == "object":
        parsed = parser.parse_object(settings)
    else:
        parsed = parser.parse_args(["--lines", GAPS] if way == "option" else ["--config", str(file)])
    assert parsed.lines.init_args.as_dict() == {"line_width": 7.5, "strength": 3.0}
    default = parser.parse_args([]).lines  # which keeps what was set of it, and has its own for the rest
    assert default.class_path.endswith("SuggestiveContours")
    assert default.init_args.interior_width == 1.2
    assert "line_width" in default.init_args


def test_a_class_that_a_file_names_takes_nothing_over(tmp_path: Path) -> None:
    parser = OwnDefaultsParser(exit_on_error=False)
    parser.add_argument("--config", action="config")
    parser.add_argument("--lines", type=LineDrawing)
    files = [tmp_path / "first.yaml", tmp_path / "second.yaml"]
    files[0].write_text(
        yaml.safe_dump({"lines": {"class_path": "Silhouette", "init_args": {"line_width": 3.0}}})
    )
    files[1].write_text(yaml.safe_dump({"lines": {"class_path": GAPS, "init_args": {"strength": 1.0}}}))
    parsed = parser.parse_args([text for file in files for text in ("--config", str(file))])
    assert parsed.lines.init_args.as_dict() == {"line_width": 7.5, "strength": 1.0}


def test_settings_without_a_class_change_the_class_that_is_there() -> None:
    parsed = build_parser().parse_args(["horse", "--lines.line_width", "3"])
    assert parsed.lines.class_path.endswith("SuggestiveContours")
    assert parsed.lines.init_args.line_width == 3


def test_an_option_is_kept_by_another_class_that_has_it() -> None:
    parsed = build_parser().parse_args(["--lines.line_width", "3", "horse", "--lines", "Brush"])
    assert parsed.lines.class_path.endswith("Brush")
    assert parsed.lines.init_args.line_width == 3


def test_fit_gives_a_third_partys_style_its_own_settings(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "a.yaml"
    file.write_text(yaml.safe_dump({"data": {"lines": {"class_path": GAPS}}}))
    assert main(["fit", "--config", str(file), "--print_config"]) == 0
    lines = yaml.safe_load(capsys.readouterr().out)["data"]["lines"]
    assert lines["init_args"] == {"line_width": 7.5, "strength": 3.0}


@pytest.mark.slow
def test_sketch_draws_a_brush_with_its_own_width(tmp_path: Path) -> None:
    drawn = [tmp_path / "named.svg", tmp_path / "spelt.svg"]
    for path, width in zip(drawn, ([], ["--lines.line_width", "2.0"]), strict=True):
        assert main(["sketch", "horse-7", "-o", str(path), "--size", "96", "--lines", "Brush", *width]) == 0
    assert drawn[0].read_text() == drawn[1].read_text()
