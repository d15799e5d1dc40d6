"""Entry point of the command line: runs a command, and reports a failure in one sentence with an exit code.

0: success. 1: failure while running. 2: invalid input. 130: interrupted by Ctrl-C. 141: broken pipe, as
after ``| head``. 143: terminated by SIGTERM after saving a checkpoint.
"""

import errno
import os
import sys
from importlib import import_module

import normalgan
from normalgan.cli.commands import COMMANDS, OTHERS, USAGE
from normalgan.cli.late_imports import gc_paused
from normalgan.cli.training.help import asked_for, overview
from normalgan.errors import (
    TRAINING_LIBRARIES,
    CommandExit,
    InputError,
    RunError,
    brief,
    did_you_mean,
    exit_caller,
    tell,
    third_party_place,
    wants_memory,
    without_extra,
)

__all__ = ["COMMANDS", "OTHERS", "TRAINING_LIBRARIES", "USAGE", "main"]


def main(arguments: list[str] | None = None) -> int:
    """Run a command and return its exit code.

    Args:
        arguments: the arguments after the program's name; by default those of the command line.
    """
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        code = _run(arguments)
        if sys.stdout is not None:  # None in a program without a console
            sys.stdout.flush()  # otherwise Python reports a full disk at exit, with a traceback
        return code
    except InputError as error:
        return _fail(str(error), 1 if isinstance(error, RunError) else 2)
    except KeyboardInterrupt as stop:
        return _fail(str(stop) or "stopped.", 130)
    except OSError as error:
        if isinstance(error, BrokenPipeError) and _nobody_reads():
            return 128 + 13  # the exit code of SIGPIPE
        return _fail(_explain(error), 1)
    except Exception as error:
        if os.environ.get("NORMALGAN_TRACEBACK"):
            raise
        if known := _known(error, arguments[0]):
            return _fail(*known)
        place = third_party_place(error)
        where = f" in {place.method}" if place else ""
        return _fail(
            f"failed while running: {type(error).__name__}: {brief(error)}{where} "
            "(set NORMALGAN_TRACEBACK=1 to see where).",
            1,
        )


def _run(arguments: list[str]) -> int:
    if not arguments or arguments[0] in {"-h", "--help"}:
        print(USAGE, end="")
        return 0 if arguments else 2
    if arguments[0] == "--version":
        print(f"normalgan {normalgan.__version__}")
        return 0
    if arguments[0] not in COMMANDS:
        raise InputError(_unknown(arguments[0]))
    try:
        if arguments[0] in OTHERS:
            with gc_paused():
                command = import_module(OTHERS[arguments[0]])
            return int(command.run(arguments[1:]))
        if asked_for(arguments)[1] == "":
            print(overview(arguments[0]), end="")
            return 0
        with gc_paused():
            from normalgan.cli.training.command import run  # lightning takes seconds to import
        return run(arguments)
    except CommandExit as stop:
        return int(stop.code or 0)
    except SystemExit as stop:  # raised by a plug-in or a callback
        raise RunError(
            f"failed while running: {exit_caller(stop)}. Raise an error to report a fault; a callback ends "
            "training with trainer.should_stop = True."
        ) from stop


def _nobody_reads() -> bool:
    """Return whether the reader of the output, such as ``head``, has exited; if so, discard all output."""
    try:
        print(flush=True)  # a flush alone proves nothing if the output is unbuffered
    except BrokenPipeError:
        # Python flushes again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return True
    return False


def _unknown(command: str) -> str:
    hint = did_you_mean(command, COMMANDS)
    return f"no command named {command!r}.{hint} The commands are {', '.join(COMMANDS)}."


def _known(error: Exception, command: str) -> tuple[str, int] | None:
    """Return the message and exit code of an error that the user can fix."""
    if isinstance(error, ModuleNotFoundError) and (sentence := without_extra(command, error)):
        return sentence, 2
    if wants_memory(error):
        return "out of memory; reduce data.batch_size, data.size or the networks' width.", 1
    return None


def _explain(error: OSError) -> str:
    where = f" {error.filename}" if error.filename else ""
    match error.errno:
        case errno.ENOSPC | errno.EDQUOT:
            return f"the disk is full{where and f' at{where}'}; free some space and run the command again."
        case errno.EROFS | errno.EACCES | errno.EPERM:
            return f"no permission to write{where}; choose another folder."
        case _:
            return f"failed while reading or writing{where}: {error.strerror or brief(error)}."


def _fail(sentence: str, code: int) -> int:
    tell(sentence)
    return code


if __name__ == "__main__":
    sys.exit(main())
