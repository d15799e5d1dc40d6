"""Refusals: what the studio's server answers when it does not do what it was asked, each with its status."""

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
    """It comes from another page, or by another name of this machine."""

    status = 403


class MissingError(RefusedError):
    """There is nothing of that name."""

    status = 404


class TooSlowError(RefusedError):
    """The body did not come in in time."""

    status = 408


class BehindError(RefusedError):
    """It changes what the server does not have."""

    status = 409


class ChangedError(RefusedError):
    """Somebody else has saved in between."""

    status = 412


class TooLargeError(RefusedError):
    """The body is larger than is read."""

    status = 413


class WrongTypeError(RefusedError):
    """The body is not of the kind that is taken."""

    status = 415


class TooManyError(RefusedError):
    """More requests than are served."""

    status = 429
