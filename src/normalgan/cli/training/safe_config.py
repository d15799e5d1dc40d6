"""--safe-config: restrict configurations to known classes, and keep them from setting output paths."""

import os
from collections.abc import Mapping, Sequence
from contextlib import ExitStack

from jsonargparse import ArgumentParser, Namespace, set_parsing_settings

from normalgan.cli.discovery import safe_imports
from normalgan.errors import InputError
from normalgan.files.addresses import is_address
from normalgan.files.limits import load_yaml
from normalgan.weights.local_classes import no_local_classes

SAFE_CONFIG = "--safe-config"
"""The option that restricts configurations to registered classes."""
_OUTPUTS = (
    *("trainer.default_root_dir", "trainer.logger", "trainer.model_registry", "checkpoint.filename"),
    *("data.cache", "output.folder", "cluster"),
)
"""Settings that write files or run code elsewhere, which are only accepted on the command line."""


def allow_known_classes_only(held: ExitStack) -> None:
    """Allow only registered classes, and some classes of torch and Lightning, to be imported and built.

    jsonargparse checks each class or function that a setting names. The restriction cannot be lifted within
    the process.

    Args:
        held: stack whose exit makes the working directory importable again.
    """
    held.enter_context(no_local_classes())
    set_parsing_settings(
        import_path_denylist=["*"],
        import_path_allowlist=safe_imports(),
        validate_subclass_spec_in_any=True,
        instantiate_subclass_spec_in_any=False,
    )


def check_outputs(parser: ArgumentParser, arguments: Sequence[str], settings: Namespace) -> None:
    """Check that no configuration sets an output path or names an address to fetch.

    Args:
        parser: parser of the command.
        arguments: arguments of the command.
        settings: settings from the arguments and the configurations.

    Raises:
        InputError: if a configuration does.
    """
    own = parser.parse_args(_set_here(arguments))
    for name in _OUTPUTS:
        if settings.get(name) != own.get(name):
            raise InputError(
                f"a configuration sets {name}, which {SAFE_CONFIG} only accepts on the command line; "
                f"pass --{name}."
            )
    checkpoint = settings.get("ckpt_path")
    if own.get("ckpt_path") != checkpoint and is_address(str(checkpoint)):
        raise InputError(f"{SAFE_CONFIG} does not fetch an address from a configuration: {checkpoint}.")


def _set_here(arguments: Sequence[str]) -> list[str]:
    """Return the arguments that set output paths directly, not through a configuration file.

    >>> _set_here(["--trainer", "theirs.yaml", "--output.folder", "maps", "--data.cache=cache"])
    ['--output.folder=maps', '--data.cache=cache']
    """
    found = []
    for word, following in zip(arguments, [*arguments[1:], ""], strict=True):
        option, joined, value = word.partition("=")
        name = option.removeprefix("--").rstrip("+")
        if any(name == output or name.startswith(f"{output}.") for output in _OUTPUTS) and word[:2] == "--":
            value = value if joined else following
            found += [] if name.startswith("trainer.logger") and _names_file(value) else [f"{option}={value}"]
    return found


def _names_file(value: object) -> bool:
    """Return whether a setting, or a part of it, names a file, which could contain a class."""
    if isinstance(value, str):
        within = load_yaml(value)
        # os.path is used because pathlib raises an error for a long text that is not a path.
        return os.path.isfile(os.path.expanduser(value)) or (within != value and _names_file(within))  # noqa: PTH111, PTH113
    parts = value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ()
    return any(map(_names_file, parts))
