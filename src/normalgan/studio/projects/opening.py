"""Opening: the project or drawing that the command line names."""

from pathlib import Path
from typing import Any

from normalgan.errors import InputError
from normalgan.files.limits import read_bounded
from normalgan.studio.drawings.imports import import_picture
from normalgan.studio.names import check_name, to_name
from normalgan.studio.projects.document_store import SUFFIX, DocumentStore
from normalgan.studio.projects.format import check_document
from normalgan.studio.server.bodies import MOST_BYTES

__all__ = ["Opened", "find_opened"]

Opened = dict[str, Any]


def find_opened(given: str, store: DocumentStore) -> Opened:
    """Return what the page opens: ``kind`` (project, document or drawing), ``name`` and the content.

    A drawing's ``content`` is its file's, which the page imports as any other.

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
    except InputError:  # missing, or not a valid name
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
        import_picture(content, str(path))  # or it is refused here
        return {"kind": "drawing", "name": to_name(path.stem), "content": content}
    try:
        return {"kind": "document", "name": to_name(path.stem), "document": check_document(content)}
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
