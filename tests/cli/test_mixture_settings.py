import json
from pathlib import Path

import pytest
from command import Bench

from normalgan.rendering.lines import LINE_DRAWINGS

VARIED = Path(__file__).parents[2] / "configs" / "lines_varied.yaml"


@pytest.mark.slow
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
