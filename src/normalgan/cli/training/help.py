"""Help of the training commands: a page that needs no imports, and the choice of a section."""

import re
from collections.abc import Sequence

from normalgan.errors import InputError, did_you_mean

__all__ = ["ALL", "COMMANDS", "SECTIONS", "asked_for", "overview"]

COMMANDS = {
    "fit": "train a generator on rendered meshes",
    "validate": "measure a checkpoint on the validation split",
    "test": "measure a checkpoint on the test split: table, baselines, gallery",
    "predict": "predict normal maps for sketches of your own",
    "render": "only render the training samples to disk",
}
"""The training commands and what each does."""

SECTIONS = {
    "trainer": "devices, precision, epochs, logger, callbacks: Lightning's Trainer",
    "model": "networks, hints, losses and their optimisers",
    "data": "meshes, animals or sketches, their pictures, split, cache and augmentation",
    "checkpoint": "which checkpoints are kept: Lightning's ModelCheckpoint",
    "pictures": "the pictures that the logger is given while training",
    "report": "what test writes",
    "output": "what predict writes",
}
"""The groups of settings and what each holds."""

ALL = "all"
"""Asks for the settings of every section."""

_MOST_USED = {
    "--config NAME|FILE": "settings: a YAML file, or one of the package, such as paper; repeats",
    "--data.meshes PATH": "folder, file or pattern of meshes to learn from",
    "--data.source CLASS": "what to learn from in place of meshes, such as Pairs of pictures",
    "--data.prediction.sketches PATH": "drawings to predict",
    "--output.folder FOLDER": "where their normal maps go",
    "--data.size PIXELS": "side of the pictures",
    "--data.batch_size N": "samples of a training step",
    "--trainer.max_epochs N": "how long to train",
    "--trainer.default_root_dir FOLDER": "where the run is kept",
    "--model.generator CLASS": "the network that predicts",
    "--model.hint_sampler CLASS": "where hints are put while training",
    "--ckpt_path FILE|last|best": "what to resume, to measure or to predict with",
    "--seed_everything N": "another number gives another run",
    "--print_config": "print the settings that result, and exit",
    "--safe-config": "let configurations name known classes only",
}
_SAMPLES, _MODEL = frozenset({"fit", "validate", "test", "render"}), frozenset(COMMANDS) - {"render"}
_USED_BY = {
    "--data.meshes PATH": _SAMPLES,
    "--data.source CLASS": _SAMPLES,
    "--data.prediction.sketches PATH": {"predict"},
    "--output.folder FOLDER": {"predict"},
    "--data.batch_size N": {"fit"},
    "--trainer.max_epochs N": {"fit"},
    "--trainer.default_root_dir FOLDER": _MODEL,
    "--model.generator CLASS": {"fit"},
    "--model.hint_sampler CLASS": {"fit"},
    "--ckpt_path FILE|last|best": _MODEL,
    "--seed_everything N": {"fit"},
}
"""The commands for which a setting is of use; all of them, unless it is named here."""


def asked_for(arguments: Sequence[str]) -> tuple[list[str], str | None]:
    """Return the arguments with a plain ``--help``, and the section after it.

    Args:
        arguments: a training command and its arguments.

    Returns:
        The section is empty if help was asked for and none was named, and None if no help was asked for.

    Raises:
        InputError: if there is no such section.

    >>> asked_for(["fit", "--help", "model"]), asked_for(["fit", "--help=all"]), asked_for(["fit", "-h"])
    ((['fit', '--help'], 'model'), (['fit', '--help'], 'all'), (['fit', '--help'], ''))
    >>> asked_for(["fit", "--data.size", "64"])
    (['fit', '--data.size', '64'], None)
    """
    for i, argument in enumerate(arguments):
        found = re.fullmatch(r"(?:-h|--help)(?:=(.*))?", argument)
        if found is None:
            continue
        after = list(arguments[i + 1 :])
        section = found[1] if found[1] is not None else ""
        if found[1] is None and after and not after[0].startswith("-"):
            section = after.pop(0)
        section = section.strip(".-")
        if section not in {"", ALL, *SECTIONS}:
            raise InputError(
                f"help has no section {section!r}.{did_you_mean(section, [*SECTIONS, ALL])} "
                f"The sections are {', '.join(SECTIONS)}, and {ALL}."
            )
        return [*arguments[:i], "--help", *after], section
    return list(arguments), None


def overview(command: str) -> str:
    """Return the page that ``--help`` alone shows: the settings most used, and how to see the others."""
    does = COMMANDS[command]
    see = {f"normalgan {command} --help {name}": what for name, what in SECTIONS.items()}
    see[f"normalgan {command} --help {ALL}"] = "all of these, and the classes that they can name"
    see[f"normalgan {command} --model.generator.help UNetGenerator"] = "the settings of a class"
    return "\n".join(
        [
            f"usage: normalgan {command} [--config FILE]... [--safe-config] [--SETTING VALUE]...",
            "",
            f"{does[0].upper()}{does[1:]}.",
            "",
            "Most used:",
            *_rows(
                {name: what for name, what in _MOST_USED.items() if command in _USED_BY.get(name, COMMANDS)}
            ),
            "",
            "All settings, by section:",
            *_rows(see),
            "",
        ]
    )


def _rows(table: dict[str, str]) -> list[str]:
    # The text of a name that is longer than the column is on the next line.
    width = 34
    return [
        f"  {name:{width}}  {what}" if len(name) <= width else f"  {name}\n  {'':{width}}  {what}"
        for name, what in table.items()
    ]
