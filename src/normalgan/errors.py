"""The one exception that means: the user gave something that cannot be used."""


class InputError(ValueError):
    """Bad input from outside: a file, a folder, a setting.

    The message is one sentence that says what was given and what would be right; the command line
    prints it without a traceback and exits with code 2 (1 if it comes up while running).
    """


def brief(error: BaseException) -> str:
    r"""Return the first line of an error's text, or its type's name if it has none.

    >>> brief(ValueError("bad shape\nlong story"))
    'bad shape'
    >>> brief(EOFError())
    'EOFError'
    """
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__
