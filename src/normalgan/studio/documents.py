"""Documents: check that a document is a project of the studio."""

from normalgan.errors import InputError
from normalgan.studio.fields import Fields, parse_fields, take_integer
from normalgan.studio.limits import LEAST_SIDE, MOST_SIDE

__all__ = ["FORMAT", "VERSION", "check_document"]

FORMAT, VERSION = "normalgan-studio", 5
_ONE_LAYER = 3
"""Up to this version a drawing had no layers of its own; what was called so were pictures to trace."""


def check_document(content: bytes) -> Fields:
    """Return a project's fields; the page checks the contents of its lists.

    Raises:
        InputError: if it is not a project, or was saved by a later version.
    """
    fields = parse_fields(content)
    if fields.get("format") != FORMAT:
        raise InputError(f'that is not a project of the studio, which begins with "format": "{FORMAT}".')
    if fields.get("version") not in range(1, VERSION + 1):
        raise InputError(
            f"the project is of another version; this studio knows 1 to {VERSION}, so update it."
        )
    for side in ("width", "height"):
        take_integer(fields, side, LEAST_SIDE, MOST_SIDE)
    layered = fields["version"] > _ONE_LAYER
    lists = ("layers", "pictures") if layered else ("strokes", "hints", "layers")
    for name, kind in (*((name, list) for name in lists), ("settings", dict)):
        if not isinstance(fields.get(name), kind):
            raise InputError(f"the project has no {name}; the file is damaged.")
    return fields
