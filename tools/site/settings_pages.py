"""Hook of the site: makes the pages of commands, settings and plug-ins from the code at build time."""

import inspect
from importlib import import_module
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from settings_tables import class_table, table

from normalgan.__main__ import OTHERS, USAGE
from normalgan.cli.discovery import REGISTRIES, SETTINGS
from normalgan.registry import summary

GROUPS = {
    "data": "What is rendered, split, stored and augmented: [data](../data.md).",
    "model": "Networks, hints, losses, optimisers: [the method](../method.md), [training](../training.md).",
    "report": "What `normalgan test` writes.",
    "output": "What `normalgan predict` writes: [prediction](../prediction.md).",
    "pictures": "The pictures that the logger is given while training.",
    "checkpoint": "Which checkpoints are kept: Lightning's `ModelCheckpoint`, with our defaults.",
    "trainer": "How long and on what: Lightning's `Trainer`, with our defaults.",
}
"""The groups of settings in the order of the page, each with a description."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages."""
    pages = {"commands": commands_page(), "settings": settings_page(), "parts": parts_page()}
    for name, text in pages.items():
        files.append(File.generated(config, f"reference/{name}.md", content=text))
    return files


def settings_page() -> str:
    """Return the page of all training settings."""
    from normalgan.cli.training.command import training_parser

    parser = training_parser("fit")
    parts = [
        "# Settings",
        "All settings of `fit`, `validate`, `test`, `predict`, `render`, as `normalgan fit --help all` has "
        "them. On the command line `--data.size 128`; in a configuration `data: {size: 128}`. Later ones "
        "win: [training](../training.md#configurations). This page is made from the code.",
        "## The run",
        "\n".join(
            line
            for line in table(parser).splitlines()
            if not any(line.startswith(f"| `--{group}") for group in GROUPS)
        ),
    ]
    for group, sentence in GROUPS.items():
        parts += [f"## {group}", sentence, table(parser, f"{group}.")]
    return "\n\n".join(parts) + "\n"


def parts_page() -> str:
    """Return the page of the package's own plug-ins and their settings."""
    parts = [
        "# Plug-ins by name",
        "What comes with the package. `normalgan plugins` also lists those of other packages; "
        "[write one](../plugins.md). A setting is given as `init_args`. This page is made from the code.",
    ]
    for kind, setting in SETTINGS.items():
        parts.append(f"## {setting}")
        registry = REGISTRIES[kind]
        for cls in registry:
            if registry.package(cls.__name__).startswith("normalgan "):
                parts += [f"### {cls.__name__}", _about(cls), class_table(cls)]
    return "\n\n".join(parts) + "\n"


def commands_page() -> str:
    """Return the page of all commands."""
    parts = [
        "# Commands",
        "What each command takes. Those that train, `fit` to `render`, share [their settings](settings.md). "
        "This page is made from the code.",
        f"```text\n{USAGE.strip()}\n```",
    ]
    for command, module in OTHERS.items():
        parser = import_module(module).build_parser()
        parts += [f"## {command}", " ".join((parser.description or "").split()), table(parser)]
    return "\n\n".join(parts) + "\n"


def _about(cls: type[Any]) -> str:
    """Return the docstring of a class up to its first section."""
    text = inspect.getdoc(cls) or summary(cls)
    kept = []
    for paragraph in text.split("\n\n"):
        if paragraph.split("\n")[0] in {
            "Args:",
            "Attributes:",
            "References:",
            "Raises:",
            "Example:",
            "Examples:",
        }:
            break
        kept.append(paragraph.replace("``", "`"))
    return "\n\n".join(kept)
