"""Names: what a project may be called, so that it is a file's name everywhere and never a path."""

import unicodedata

from normalgan.errors import InputError

LONGEST = 80
_MOST_BYTES = 200  # file systems allow 255, of which a suffix and a temporary name take some


def check_name(name: str) -> str:
    """Return a name in Unicode's composed form.

    Raises:
        InputError: if it holds anything but letters, digits, spaces, - and _, or is too long.

    >>> check_name("Fuchs im Schnee_2")
    'Fuchs im Schnee_2'
    """
    name = unicodedata.normalize("NFC", name)
    plain = all(each in " -_" or unicodedata.category(each)[0] in "LMN" for each in name)
    if not plain or name != name.strip() or not 1 <= len(name) <= LONGEST or _too_long(name):
        raise InputError(
            f"{name[:LONGEST]!r} is no name; it has 1 to {LONGEST} letters, digits, spaces, - and _, and "
            "no space at its ends."
        )
    return name


def _too_long(name: str) -> bool:
    return len(name.encode()) > _MOST_BYTES
