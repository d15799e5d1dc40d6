"""Refusals: the errors of the studio's server with their HTTP status codes."""

from normalgan.errors import InputError


class RefusedError(InputError):
    """A refused request; its message is one sentence for the user."""

    status = 400


class ForeignError(RefusedError):
    """The request comes from another page or names another host."""

    status = 403


class MissingError(RefusedError):
    """The document does not exist."""

    status = 404


class TooSlowError(RefusedError):
    """The body arrived too slowly."""

    status = 408


class BehindError(RefusedError):
    """The request changes pixels that the server does not have."""

    status = 409


class ChangedError(RefusedError):
    """The document has changed since it was read."""

    status = 412


class TooLargeError(RefusedError):
    """The body exceeds the size limit."""

    status = 413


class WrongTypeError(RefusedError):
    """The body has a type that is not accepted."""

    status = 415
