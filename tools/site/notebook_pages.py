"""Hook of the site: turns notebooks into pages, with the pictures and tables of their stored run."""

from pathlib import Path

import nbformat
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from nbconvert import MarkdownExporter

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page for each notebook, and its pictures."""
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        notebook = nbformat.read(path, as_version=4)
        exporter = MarkdownExporter()
        text, resources = exporter.from_notebook_node(
            notebook, {"unique_key": path.stem, "output_files_dir": path.stem}
        )
        text = text.replace(
            "](../docs/", "](../"
        )  # the page lies in the site's notebooks/, and docs/ is the root
        note = f"\n*This page is the notebook `notebooks/{path.name}`; every cell is run by the tests.*\n"
        heading, _, rest = text.lstrip().partition("\n")
        files.append(File.generated(config, f"notebooks/{path.stem}.md", content=f"{heading}\n{note}{rest}"))
        for name, content in resources["outputs"].items():
            files.append(File.generated(config, f"notebooks/{name}", content=content))
    return files
