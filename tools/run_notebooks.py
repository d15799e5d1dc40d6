"""Runs notebooks and stores their outputs: tools/run_notebooks.py [-o FOLDER] NOTEBOOK...

The site shows the stored run, so run this after any change to a notebook. The tests run the notebooks too,
and check that the stored outputs belong to the current code.
"""

import argparse
import hashlib
import os
from pathlib import Path

import nbformat
from nbclient import NotebookClient


def fingerprint(notebook: nbformat.NotebookNode) -> str:
    """Return a fingerprint of a notebook's code, which a stored run carries."""
    sources = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
    return hashlib.sha256("\n\n".join(sources).encode()).hexdigest()[:16]


def run(path: Path) -> nbformat.NotebookNode:
    """Return a notebook with the outputs of a fresh run, without details that change from run to run.

    Raises:
        nbclient.exceptions.CellExecutionError: if a cell fails; the message says which and why.
    """
    notebook: nbformat.NotebookNode = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=600, kernel_name="python3", record_timing=False).execute()
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = [out for out in cell.outputs if out.get("name") != "stderr"]  # library notices
            cell.metadata.clear()
    notebook.metadata["language_info"] = {"name": "python"}
    notebook.metadata["normalgan"] = {"code": fingerprint(notebook)}
    return notebook


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("notebooks", nargs="+", type=Path)
    parser.add_argument("-o", "--output", type=Path, help="another folder than the notebook's own")
    options = parser.parse_args()
    os.environ.setdefault("PYDEVD_DISABLE_FILE_VALIDATION", "1")  # suppresses a debugger's notice
    for each in options.notebooks:
        done = run(each)
        nbformat.write(done, (options.output or each.parent) / each.name)
