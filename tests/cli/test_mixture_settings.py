import json
from pathlib import Path

import pytest
from command import CONF, Bench, run

from normalgan.rendering.lines import LINE_DRAWINGS

VARIED = Path(__file__).parents[2] / "configs" / "lines_varied.yaml"


def mixture(styles: str) -> str:
    return f"{{class_path: Mixture, init_args: {{styles: [{styles}]}}}}"


def test_the_varied_overlay_renders_in_every_style_there_is(bench: Bench, tmp_path: Path) -> None:
    few = ("--data.train_views", 2, "--data.val_views", 1, "--data.test_views", 1)
    done = bench.run("render", tmp_path, "--config", VARIED, "--data.cache", tmp_path, *few)
    assert done.code == 0, done.err
    (described,) = tmp_path.glob("*/dataset.json")
    lines = json.loads(described.read_text(encoding="utf-8"))["recipe"]["lines"]
    assert lines["class"] == "Mixture"
    assert len(lines["weights"]) == len(lines["styles"])
    assert {style["class"] for style in lines["styles"]} == set(LINE_DRAWINGS.names()) - {"Mixture"}
    assert {style["line_width"] for style in lines["styles"]} >= {0.8, 4.0}


@pytest.mark.parametrize(
    ("lines", "answer"),
    [
        (mixture("{class_path: Silhouete}"), "no LineDrawing named 'Silhouete'. Did you mean Silhouette?"),
        (mixture("{class_path: Silhouette, init_args: {line_widht: 2}}"), "Did you mean line_width?"),
        (mixture(""), "the styles of Mixture are an empty list; name at least one line style."),
    ],
)
def test_mistakes_in_a_mixture_are_told_in_a_sentence(lines: str, answer: str, tmp_path: Path) -> None:
    config = tmp_path / "lines.yaml"
    config.write_text(f"data: {{lines: {lines}}}\n")
    small = ("--config", CONF / "tiny.yaml")  # the networks by default are large, and come first
    run("fit", *small, "--config", config, "--trainer.default_root_dir", tmp_path / "run").refused(answer)
