"""Opening: the project or drawing that the command line names, for the page."""

from pathlib import Path
from typing import Any

from normalgan.errors import InputError
from normalgan.files.limits import read_bounded
from normalgan.studio.bodies import MOST_BYTES
from normalgan.studio.document_store import SUFFIX, DocumentStore
from normalgan.studio.documents import check_document
from normalgan.studio.names import check_name, to_name
from normalgan.studio.pictures import Imported, import_layers, import_picture
from normalgan.studio.refusals import MissingError

__all__ = ["Opened", "find_opened"]

Opened = dict[str, Any]


def find_opened(given: str, store: DocumentStore) -> Opened:
    """Return what the page is to open: ``kind`` (project, document or drawing), ``name``, and the rest of it.

    A drawing comes as `import_picture` gives it, and with its ``layers`` as `import_layers` gives them: with
    an ``error`` where they cannot be read, and None if the file has none.

    Args:
        given: name of a project, a ``.normalgan`` file, or a drawing's file.
        store: the projects.

    Raises:
        InputError: if it is none of these.
    """
    path = Path(given)
    if path.is_file():
        return _of_file(path)
    try:
        store.read(given)
    except MissingError:
        pass
    except InputError:  # no name of a project
        pass
    else:
        return {"kind": "project", "name": check_name(given)}
    raise InputError(
        f"there is neither a project nor a file called {given}; give a project's name or a drawing's file."
    )


def _of_file(path: Path) -> Opened:
    try:
        content = read_bounded(path, MOST_BYTES)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from None
    name = to_name(path.stem)
    if path.suffix.lower() != SUFFIX:
        drawing = import_picture(content, str(path))
        layers = _layers(content, str(path)) if drawing["layered"] else None
        return {"kind": "drawing", "name": name, **drawing, "layers": layers}
    try:
        return {"kind": "document", "name": name, "document": check_document(content)}
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _layers(content: bytes, name: str) -> Imported:
    """Return the layers of a file; where they cannot be read ``error`` says why: it may be one drawing."""
    try:
        return import_layers(content, name)
    except InputError as error:
        return {"error": str(error)}
