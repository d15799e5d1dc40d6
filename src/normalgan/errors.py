"""Exceptions that are reported in one sentence, without a traceback."""

import difflib
import errno
import json
import re
import sys
import traceback
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from pydantic import ValidationError


_STEERING = re.compile(r"[\0-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Characters that control a terminal, break a line, change the writing direction, or cannot be encoded."""


FOREIGN_ERRORS = (Exception, SystemExit)
"""What third-party code may raise; ``sys.exit`` in a plug-in would otherwise end the command silently."""


TRAINING_LIBRARIES = (
    *("torch", "lightning", "torchmetrics", "safetensors", "onnx", "kornia", "embreex", "mapbox_earcut"),
    *("pyrender", "zarr", "fsspec", "tensorboard", "matplotlib"),
)
"""Import names of the packages in pyproject.toml's ``train`` extra."""


class InputError(ValueError):
    """Invalid input from the user: a file, a folder, a setting.

    The message is one sentence on what was given and what is accepted. The command line prints it without
    a traceback and exits with code 2.
    """


class RunError(InputError):
    """A failure while running, such as a full disk or too little memory.

    It is reported in one sentence like any `InputError`, with exit code 1.
    """


class CommandExit(SystemExit):
    """Ends a command early, after a parser printed its help or a signal stopped the studio."""


def unwritable(sentence: str, error: OSError) -> InputError:
    """Return the error for a file that could not be written."""
    return (RunError if error.errno in {errno.ENOSPC, errno.EDQUOT} else InputError)(sentence)


@contextmanager
def writing(what: str, place: object = None) -> Iterator[None]:
    """Convert an `OSError` within the context to the error for something that could not be written.

    Args:
        what: subject of the sentence, such as ``the map``.
        place: where it is written; None names the file of the error.
    """
    try:
        yield
    except OSError as error:
        there = error.filename if place is None else place
        raise unwritable(f"{what} cannot be written to {there}: {error.strerror}.", error) from error


def wants_memory(error: BaseException) -> bool:
    """Return whether an error means that memory ran out.

    torch and ONNX Runtime raise a plain RuntimeError in that case.

    >>> wants_memory(RuntimeError("Exception during initialization: std::bad_alloc"))
    True
    """
    said = ("out of memory", "can't allocate", "Cannot allocate", "bad_alloc", "Failed to allocate memory")
    return isinstance(error, MemoryError) or any(each in str(error) for each in said)


def without_extra(what: object, error: ModuleNotFoundError) -> str:
    """Return a sentence that asks for the ``train`` extra if one of its libraries is missing, else nothing.

    >>> without_extra("fit", ModuleNotFoundError(name="torch"))
    "fit needs torch, which a plain installation leaves out; install it with pip install 'normalgan[train]'."
    """
    if str(error.name).partition(".")[0] not in TRAINING_LIBRARIES:
        return ""
    return (
        f"{what} needs {error.name}, which a plain installation leaves out; install it with pip install "
        "'normalgan[train]'."
    )


def with_subject(what: object, error: InputError) -> InputError:
    """Return the error with its subject named in the message."""
    text = str(error)
    return type(error)(text if str(what) in text else f"{what}: {text}")


def printable(name: object) -> str:
    r"""Return a name with line breaks and terminal control codes escaped; letters of any script are kept.

    >>> printable("a\nfast  \x1b[2Jhorse.png")
    'a\\nfast  \\x1b[2Jhorse.png'
    """
    return _STEERING.sub(lambda found: repr(found[0])[1:-1], str(name))


def _one_line(text: str) -> str:
    r"""Return text as one printable line, because names in files may contain terminal control codes.

    >>> _one_line("the mesh \x1b[2Jhorse\n is missing")
    'the mesh \\x1b[2Jhorse is missing'
    """
    return printable(" ".join(text.split()))


def tell(message: object) -> None:
    """Print a one-line message to stderr, prefixed with the program's name."""
    print(f"normalgan: {_one_line(str(message))}", file=sys.stderr, flush=True)


class Place(NamedTuple):
    """A place in the code: a method such as ``Dots.sample``, its file, and the line."""

    method: str
    file: str
    line: int


def third_party_place(error: BaseException) -> Place | None:
    """Return the place where a third-party subclass of one of our classes raised an error, if one did."""
    found: Place | None = None
    for frame, line in traceback.walk_tb(error.__traceback__):
        owner, file = type(frame.f_locals.get("self")), frame.f_code.co_filename
        ours = [base.__module__.partition(".")[0] == "normalgan" for base in owner.__mro__]
        if not ours[0] and any(ours):
            found = Place(f"{owner.__name__}.{frame.f_code.co_name}", file, line)
        elif found is not None and file == found.file:
            found = found._replace(line=line)
    return found


def exit_caller(stop: SystemExit) -> str:
    """Return the line that ended the program, such as ``dots.py, line 12, called sys.exit(0)``."""
    frames = [
        (frame.f_code, line)
        for frame, line in traceback.walk_tb(stop.__traceback__)
        if frame.f_code.co_filename != "<frozen _sitebuiltins>"  # exit(), which calls sys.exit
    ]
    code, line = frames[-1]
    given = "" if stop.code is None else repr(stop.code)
    return f"{Path(code.co_filename).name}, line {line}, called sys.exit({given})"


def brief(error: BaseException) -> str:
    r"""Return the first line of an error's message, or the name of its type if the message is empty.

    >>> brief(ValueError("bad shape\nlong story"))
    'bad shape'
    >>> brief(EOFError())
    'EOFError'
    """
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__


def did_you_mean(given: str, known: Iterable[str], cutoff: float = 0.6) -> str:
    """Return " Did you mean …?" with the closest known name; empty if no name is close.

    Args:
        given: the unknown name.
        known: the known names.
        cutoff: minimum similarity in [0, 1], as in `difflib.get_close_matches`.

    >>> did_you_mean("hrose", ["house", "horse"])
    ' Did you mean horse?'
    """
    near = difflib.get_close_matches(given, list(known), cutoff=cutoff)
    # difflib scores "hrose" the same against "house" and "horse", so anagrams are preferred.
    near.sort(key=lambda name: sorted(name) != sorted(given))
    return f" Did you mean {near[0]}?" if near else ""


def sentence_of(error: "ValidationError", whole: str = "the request") -> str:
    """Return pydantic's first finding as one sentence.

    Args:
        error: the error that pydantic raised.
        whole: name of the validated object, for errors that concern no single field.
    """
    first = error.errors(include_url=False)[0]
    steps = [step for step in first["loc"] if step != "[key]"]
    where = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in steps).removeprefix(".")
    match first["type"]:
        case "json_invalid":
            return f"{whole} is not JSON: {first['ctx']['error']}."
        case "missing" | "missing_argument":
            return f"{where} is missing."
        case "value_error":
            said = str(first["ctx"]["error"])
            return f"{where}{': ' if where else ''}{said}{'' if said.endswith(('.', '?')) else '.'}"
    # For example "Input should be …" or "Tuple should have at most 9 items after validation, not 10".
    _, should, accepted = first["msg"].replace(" after validation", "").partition(" should ")
    accepted = re.sub(r"\b(a|an) (valid )?dictionary( or an instance of \w+)?", "a table", accepted)
    words = re.findall("'(.+?)'", accepted) if first["type"] == "literal_error" else []
    near = did_you_mean(str(first["input"]), words)
    return f"{where or whole} is {_shown(first['input'])}; it{should}{accepted}.{near}"


def _shown(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False, default=repr)
    return text if len(text) <= 40 else f"{text[:37]}…"
