"""The figures that `normalgan test` wrote."""

import json
from pathlib import Path
from typing import Any


def written_by_test(run: Path) -> Path:
    """Return the newest metrics.json in the folder of a run."""
    return max((run / "test").rglob("metrics.json"), key=lambda file: file.stat().st_mtime_ns)


def figures_of(run: Path) -> Any:
    """Return the newest figures of a run, without what says what was measured."""
    content = json.loads(written_by_test(run).read_text())
    content.pop("run")
    return content
