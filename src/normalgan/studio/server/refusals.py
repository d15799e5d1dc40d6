"""Refusals: the errors of the studio's server with their HTTP status codes."""

from normalgan.errors import InputError


class RefusedError(InputError):
    """A refused request.

    Args:
        sentence: message for the user.
        status: HTTP status code of the response.
    """

    def __init__(self, sentence: str, status: int = 400) -> None:
        super().__init__(sentence)
        self.status = status


class MissingError(RefusedError):
    """The document does not exist."""

    def __init__(self, sentence: str) -> None:
        super().__init__(sentence, 404)


class BehindError(RefusedError):
    """The request changes pixels that the server does not have."""

    def __init__(self, sentence: str) -> None:
        super().__init__(sentence, 409)


class ChangedError(RefusedError):
    """The document has changed since it was read."""

    def __init__(self, sentence: str) -> None:
        super().__init__(sentence, 412)
