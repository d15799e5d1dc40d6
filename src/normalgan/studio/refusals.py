"""Refusals: the errors of the studio's server, each with its HTTP status."""

from normalgan.errors import InputError

__all__ = [
    "BehindError",
    "ChangedError",
    "ForeignError",
    "MissingError",
    "RefusedError",
    "TooLargeError",
    "TooManyError",
    "TooSlowError",
    "WrongTypeError",
]


class RefusedError(InputError):
    """A request that is not served; its message is one sentence for the user."""

    status = 400


class ForeignError(RefusedError):
    """The request comes from another page or names another host."""

    status = 403


class MissingError(RefusedError):
    """Nothing has that name."""

    status = 404


class TooSlowError(RefusedError):
    """The body did not come in in time."""

    status = 408


class BehindError(RefusedError):
    """The request changes pixels that the server does not have."""

    status = 409


class ChangedError(RefusedError):
    """Somebody else has saved in the meantime."""

    status = 412


class TooLargeError(RefusedError):
    """The body exceeds the size limit."""

    status = 413


class WrongTypeError(RefusedError):
    """The body has a type that is not accepted."""

    status = 415


class TooManyError(RefusedError):
    """More requests than are served."""

    status = 429
