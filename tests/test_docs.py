"""The documentation: its Python runs, and its links, files and tests exist."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from normalgan.__main__ import main

ROOT = Path(__file__).parents[1]
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "examples").glob("*/*.md")),
]


def page_id(path: Path) -> str:
    return str(path.relative_to(ROOT))


def blocks(page: Path, language: str) -> list[str]:
    """Return the fenced blocks of a page in one language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)


def prose(page: Path) -> str:
    """Return a page without its fenced blocks."""
    return re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)


def links(page: Path) -> list[str]:
    """Return where a page's links and pictures lead."""
    return re.findall(r"\]\(([^)\s]+)\)", prose(page))


def anchors(page: Path) -> set[str]:
    """Return the names under which a page's headings can be linked to."""
    headings = re.findall(r"^#+ (.+)$", prose(page), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def run_python(page: Path, folder: Path) -> None:
    """Run the blocks of a page one after the other in a fresh interpreter, as a reader would."""
    run_code("\n".join(blocks(page, "python")), folder)


def run_code(code: str, folder: Path) -> None:
    """Run code in a fresh interpreter."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]


@pytest.mark.slow  # imports all there is
def test_python_of_the_plugins_runs(tmp_path: Path) -> None:
    run_python(ROOT / "docs" / "plugins.md", tmp_path)


@pytest.mark.slow  # imports all there is, and renders
def test_example_plugins_pass_their_checks(tmp_path: Path) -> None:
    files = sorted(map(str, (ROOT / "examples" / "plugins").glob("*.py")))
    assert len(files) == 10
    code = f"import runpy\nfor path in {files}: runpy.run_path(path, run_name='__main__')"
    run_code(code, tmp_path)


@pytest.mark.slow  # imports lightning, renders and trains
def test_python_of_the_public_face_runs_and_commands_read_what_its_ten_lines_save(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (ten,) = (block for block in blocks(ROOT / "docs" / "python.md", "python") if "trainer.fit" in block)
    assert len([line for line in ten.splitlines() if line.strip()]) <= 10
    run_python(ROOT / "docs" / "python.md", tmp_path)
    monkeypatch.chdir(tmp_path)
    assert main(["export", "mine.ckpt", "-o", "model.safetensors"]) == 0
    sketch = str(ROOT / "examples" / "sketches" / "horse.png")
    command = [
        "predict",
        "--ckpt_path",
        "mine.ckpt",
        "--data.size",
        "32",
        "--data.prediction.sketches",
        sketch,
    ]
    assert main([*command, "--trainer.accelerator", "cpu", "--trainer.enable_progress_bar", "false"]) == 0
    assert list((tmp_path / "normals").glob("*_normal.png"))
    plan = {
        **{"name": "Ten lines", "images": 1, "gallery": 1},
        "rows": [{"name": "mean", "label": "mean", "classical": "constant"}],
        "data": {
            "animals": {"count": 3},
            "split": {"fractions": [0.34, 0.33, 0.33]},
            "size": 32,
            **{"train_views": 1, "val_views": 1, "test_views": 1},
            "storage": {"render_workers": 0},
        },
    }
    (tmp_path / "plan.yaml").write_text(yaml.safe_dump(plan))
    assert main(["benchmark", "--config", "plan.yaml", "--evaluate", "mine.ckpt", "--output", "bench"]) == 0


@pytest.mark.slow  # trains five small models
def test_the_example_of_a_sweep_runs(tmp_path: Path) -> None:
    run_code((ROOT / "examples" / "sweep.py").read_text(encoding="utf-8"), tmp_path)
    assert len(list((tmp_path / "sweep").glob("*/checkpoints/last.ckpt"))) == 5
    with pytest.raises(AssertionError, match="sweep already holds a sweep"):  # no trial could train
        run_code((ROOT / "examples" / "sweep.py").read_text(encoding="utf-8"), tmp_path)


def test_no_page_with_python_is_forgotten() -> None:
    with_python = {page.stem for page in PAGES if blocks(page, "python")}
    assert with_python == {"plugins", "python"}


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_links_and_pictures_are_there(page: Path) -> None:
    for target in links(page):
        if target.startswith(("https://", "http://")):
            continue
        path, _, anchor = target.partition("#")
        there = (page.parent / path).resolve() if path else page
        assert there.exists(), f"{page_id(page)} links to {target}"
        assert there.is_relative_to(ROOT)
        if anchor:
            assert anchor in anchors(there), f"{page_id(page)} links to {target}"


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_yaml_is_yaml(page: Path) -> None:
    for block in [*blocks(page, "yaml"), *blocks(page, "json")]:
        assert isinstance(yaml.safe_load(block), dict)


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_files_that_commands_name_are_there(page: Path) -> None:
    commands = "\n".join(blocks(page, "sh"))
    for path in re.findall(r"(?<!\S)(?:configs|tools|examples|\.ci)/[\w./-]+", commands):
        assert (ROOT / path).exists(), f"{page_id(page)} names {path}"


def test_every_page_of_the_docs_can_be_reached() -> None:
    linked = {(page.parent / link.partition("#")[0]).resolve() for page in PAGES for link in links(page)}
    assert set(PAGES) - {ROOT / "README.md", *(ROOT / "examples").glob("*/*.md")} <= linked


def test_pictures_are_small_and_used() -> None:
    used = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    pictures = list((ROOT / "docs" / "pictures").iterdir())
    assert pictures
    for picture in pictures:
        # Six pictures of maps in one, which a palette would show in bands.
        assert picture.stat().st_size < (500_000 if picture.name == "studio_film.png" else 300_000)
        assert f"pictures/{picture.name}" in used


def test_trust_names_tests_that_exist() -> None:
    named = re.findall(r"`(tests/[\w/]+\.py)`", (ROOT / "docs" / "trust.md").read_text(encoding="utf-8"))
    assert len(set(named)) > 20
    assert not [path for path in named if not (ROOT / path).is_file()]
