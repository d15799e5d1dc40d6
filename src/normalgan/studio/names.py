"""Names: valid project names, which are file names on every system and never paths."""

import unicodedata

from normalgan.errors import InputError

LONGEST = 80
_DEVICES = frozenset(
    ["con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in "0123456789¹²³")]
)
"""Device names on Windows, which cannot be file names, with or without a suffix."""
_MOST_BYTES = 200  # file systems allow 255; a suffix and a temporary name need some of them


def check_name(name: str) -> str:
    """Return a valid name in Unicode's composed form (NFC).

    Raises:
        InputError: if the name has characters other than letters, digits, spaces, - and _, or is too long.

    >>> check_name("Fuchs im Schnee_2")
    'Fuchs im Schnee_2'
    """
    name = unicodedata.normalize("NFC", name)
    if not is_name(name):
        raise InputError(
            f"{name[:LONGEST]!r} is not a valid name; use 1 to {LONGEST} letters, digits, spaces, - and _, "
            "no space at an end, and no name of a Windows device, such as CON."
        )
    return name


def is_name(name: str) -> bool:
    """Return whether a name is valid for a project.

    >>> is_name("fox"), is_name("../fox"), is_name(" fox")
    (True, False, False)
    """
    fits = 1 <= len(name) <= LONGEST and len(name.encode(errors="replace")) <= _MOST_BYTES
    fits = fits and name.lower() not in _DEVICES
    return fits and name == name.strip() and all(map(_is_plain, name))


def to_name(text: str) -> str:
    """Return the valid name closest to a text.

    >>> to_name("fox (2)."), to_name("..."), to_name("CON")
    ('fox 2', 'drawing', 'CON_')
    """
    plain = "".join(filter(_is_plain, unicodedata.normalize("NFC", text)))[:LONGEST]
    while len(plain.encode()) > _MOST_BYTES:
        plain = plain[:-1]
    plain = plain.strip() or "drawing"
    return plain if is_name(plain) else f"{plain}_"


def _is_plain(character: str) -> bool:
    return character in " -_" or unicodedata.category(character)[0] in "LMN"
