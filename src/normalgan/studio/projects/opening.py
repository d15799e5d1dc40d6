"""Opening: find the project or drawing that the command line names."""

from pathlib import Path
from typing import Any

from normalgan.errors import InputError
from normalgan.files.limits import read_bounded
from normalgan.studio.drawings.imports import import_picture
from normalgan.studio.names import check_name, to_name
from normalgan.studio.projects.document_store import SUFFIX, DocumentStore
from normalgan.studio.projects.format import check_document
from normalgan.studio.server.bodies import MOST_BYTES

Opened = dict[str, Any]


def find_opened(given: str, store: DocumentStore) -> Opened:
    """Return the ``kind`` (project, document or drawing), ``name`` and ``content`` of what the page opens.

    The content of a drawing is its file, which the page imports like any other.

    Args:
        given: name of a project, or path of a ``.normalgan`` file or a drawing.
        store: the saved projects.

    Raises:
        InputError: if ``given`` is none of these.
    """
    path = Path(given)
    if path.is_file():
        return _of_file(path)
    try:
        store.read(given)
    except InputError:  # not found, or not a valid name
        raise InputError(
            f"there is neither a project nor a file called {given}; "
            "give a project's name or a drawing's file."
        ) from None
    return {"kind": "project", "name": check_name(given)}


def _of_file(path: Path) -> Opened:
    try:
        content = read_bounded(path, MOST_BYTES)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from None
    if path.suffix.lower() != SUFFIX:
        import_picture(content, str(path))  # raises the error if the page could not import it
        return {"kind": "drawing", "name": to_name(path.stem), "content": content}
    try:
        return {"kind": "document", "name": to_name(path.stem), "document": check_document(content)}
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
