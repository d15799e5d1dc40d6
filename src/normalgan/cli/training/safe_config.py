"""--safe-config: configurations from others name known classes only, and do not say where a run writes."""

import os
from collections.abc import Mapping, Sequence
from contextlib import ExitStack

from jsonargparse import ArgumentParser, Namespace, set_parsing_settings

from normalgan.cli.discovery import safe_imports
from normalgan.errors import InputError
from normalgan.files.addresses import is_address
from normalgan.files.limits import load_yaml
from normalgan.weights.local_classes import no_local_classes

__all__ = ["SAFE_CONFIG", "allow_known_classes_only", "check_outputs"]

SAFE_CONFIG = "--safe-config"
"""The option under which only registered classes are imported and built."""
_OUTPUTS = (
    *("trainer.default_root_dir", "trainer.logger", "trainer.model_registry", "checkpoint.filename"),
    *("data.cache", "output.folder", "cluster"),
)
"""Settings that write, or run elsewhere: they are taken from the command line alone."""


def allow_known_classes_only(held: ExitStack) -> None:
    """Import and build only registered classes, and a few of torch and Lightning.

    jsonargparse checks each class or function that a setting names; within a process this cannot be relaxed
    again.

    Args:
        held: ends the exclusion of classes in the working directory.
    """
    held.enter_context(no_local_classes())
    set_parsing_settings(
        import_path_denylist=["*"],
        import_path_allowlist=safe_imports(),
        validate_subclass_spec_in_any=True,
        instantiate_subclass_spec_in_any=False,
    )


def check_outputs(parser: ArgumentParser, arguments: Sequence[str], settings: Namespace) -> None:
    """Check that no configuration says where the run writes, or names an address to fetch.

    Args:
        parser: the command's parser.
        arguments: its arguments.
        settings: the settings that they and the configurations give.

    Raises:
        InputError: if one does.
    """
    own = parser.parse_args(_set_here(arguments))
    for name in _OUTPUTS:
        if settings.get(name) != own.get(name):
            raise InputError(
                f"a configuration sets {name}, and {SAFE_CONFIG} takes it from the command line alone: "
                f"give --{name}."
            )
    checkpoint = settings.get("ckpt_path")
    if own.get("ckpt_path") != checkpoint and is_address(str(checkpoint)):
        raise InputError(f"{SAFE_CONFIG} fetches no address that a configuration names: {checkpoint}.")


def _set_here(arguments: Sequence[str]) -> list[str]:
    """Return the arguments that set outputs directly, not through a configuration file.

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
    """Return whether a setting, or a part of it, names a file, from which a class may be read."""
    if isinstance(value, str):
        within = load_yaml(value)
        # os.path, because pathlib raises an error for a long text that is not a path.
        return os.path.isfile(os.path.expanduser(value)) or (within != value and _names_file(within))  # noqa: PTH111, PTH113
    parts = value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ()
    return any(map(_names_file, parts))
