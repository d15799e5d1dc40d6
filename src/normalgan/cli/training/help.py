"""Help of the training commands: an overview that needs no imports, and one page per section."""

import re
from collections.abc import Sequence

from normalgan.errors import InputError, did_you_mean

COMMANDS = {
    "fit": "train a generator on rendered meshes",
    "validate": "measure a checkpoint on the validation split",
    "test": "measure a checkpoint on the test split: table, baselines, gallery",
    "predict": "predict normal maps for your own sketches",
    "render": "only render the training samples to disk",
}
"""The training commands and their descriptions."""

SECTIONS = {
    "trainer": "devices, precision, epochs, logger, callbacks: Lightning's Trainer",
    "model": "networks, hints, losses and optimisers",
    "data": "meshes, animals or sketches; rendering, split, cache and augmentation",
    "checkpoint": "which checkpoints are kept: Lightning's ModelCheckpoint",
    "pictures": "pictures that are logged during training",
    "report": "what test writes",
    "output": "what predict writes",
}
"""The groups of settings and their descriptions."""

ALL = "all"
"""Section name that selects the settings of all sections."""

_SAMPLES, _MODEL = ("fit", "validate", "test", "render"), ("fit", "validate", "test", "predict")
_ALL = tuple(COMMANDS)
_MOST_USED: dict[str, tuple[tuple[str, ...], str]] = {
    "--config NAME|FILE": (_ALL, "YAML file of settings, or a shipped one such as paper; can be repeated"),
    "--data.meshes PATH": (_SAMPLES, "folder, file or pattern of training meshes"),
    "--data.source CLASS": (_SAMPLES, "source of training data other than meshes, such as Pairs"),
    "--data.prediction.sketches PATH": (("predict",), "drawings to predict"),
    "--output.folder FOLDER": (("predict",), "output folder of the normal maps"),
    "--data.size PIXELS": (_ALL, "side of the pictures in pixels"),
    "--data.batch_size N": (("fit",), "number of samples per training step"),
    "--trainer.max_epochs N": (("fit",), "duration of training"),
    "--trainer.default_root_dir FOLDER": (_MODEL, "folder of the run"),
    "--model.generator CLASS": (("fit",), "the network that predicts"),
    "--model.hint_sampler CLASS": (("fit",), "sampler that places hints during training"),
    "--ckpt_path FILE|last|best": (_MODEL, "model to resume, measure or predict with"),
    "--seed_everything N": (("fit",), "seed of the run"),
    "--print_config": (_ALL, "print the resulting settings and exit"),
    "--safe-config": (_ALL, "only let configurations name known classes"),
}
"""The most used settings, with the commands that use them and their descriptions."""


def asked_for(arguments: Sequence[str]) -> tuple[list[str], str | None]:
    """Return the arguments with a plain ``--help``, and the section that followed it.

    Args:
        arguments: a training command and its arguments.

    Returns:
        The arguments and the section, which is empty if ``--help`` names none, and None without ``--help``.

    Raises:
        InputError: if the section does not exist.

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
    """Return the output of a plain ``--help``: the most used settings, and how to list the others."""
    does = COMMANDS[command]
    see = {f"normalgan {command} --help {name}": what for name, what in SECTIONS.items()}
    see[f"normalgan {command} --help {ALL}"] = "all of these, and the classes they can name"
    see[f"normalgan {command} --model.generator.help UNetGenerator"] = "the settings of a class"
    return "\n".join(
        [
            f"usage: normalgan {command} [--config FILE]... [--safe-config] [--SETTING VALUE]...",
            "",
            f"{does[0].upper()}{does[1:]}.",
            "",
            "Most used:",
            *_rows({name: what for name, (users, what) in _MOST_USED.items() if command in users}),
            "",
            "All settings, by section:",
            *_rows(see),
            "",
        ]
    )


def _rows(table: dict[str, str]) -> list[str]:
    # The description of a long name goes on the next line.
    width = 34
    return [
        f"  {name:{width}}  {what}" if len(name) <= width else f"  {name}\n  {'':{width}}  {what}"
        for name, what in table.items()
    ]
