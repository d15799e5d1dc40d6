"""normalgan plugins: list the classes that settings can name, and the plug-ins that failed to load."""

import json
from collections.abc import Mapping
from typing import Any, Literal

from normalgan.cli.late_imports import gc_paused
from normalgan.cli.parsing.light_parser import LightParser
from normalgan.registry import LeftOut, Registry, class_path, summary

Kind = Literal[
    "renderer",
    "lines",
    "hint_sampler",
    "generator",
    "discriminator",
    "objective",
    "reconstruction",
    "source",
    "augmentation",
    "metrics",
    "output",
]
"""The kinds of plug-ins, named after the last part of their setting."""


def run(arguments: list[str]) -> int:
    """List plug-ins and return the exit code, which is 0 even if some failed to load.

    Raises:
        InputError: if an argument is invalid.
    """
    settings = build_parser().parse_args(arguments)
    # Imported here because torch takes seconds to import; errors in the arguments are reported first.
    with gc_paused():
        from normalgan.cli.discovery import REGISTRIES, SETTINGS, misplaced

    chosen = {kind: REGISTRIES[kind] for kind in REGISTRIES if settings.kind in {None, kind}}
    for registry in chosen.values():
        registry.discover()
    left_out = [left for registry in chosen.values() for left in registry.left_out] + misplaced()
    print((_as_json if settings.json else _as_text)(chosen, SETTINGS, left_out))
    return 0


def build_parser() -> LightParser:
    """Return the parser of the command line."""
    parser = LightParser(
        prog="normalgan plugins",
        usage="%(prog)s [--kind KIND] [--json]",
        description="List the classes that settings can name, and what was left out and why.",
    )
    parser.add_argument("--kind", type=Kind | None, help="only list plug-ins of this kind")
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")
    return parser


def _as_text(
    chosen: Mapping[str, Registry[Any]], settings: Mapping[str, str], left_out: list[LeftOut]
) -> str:
    lines = []
    for kind, registry in chosen.items():
        rows = [(cls.__name__, registry.package(cls.__name__), summary(cls)) for cls in registry]
        name, package = (max(len(row[i]) for row in rows) for i in (0, 1))
        form = "'[NAME]'" if kind == "metrics" else "NAME"  # metrics are the only kind that settings list
        how = f"--{settings[kind]} {form}" if kind in settings else "options of generate and predict"
        lines += [f"{kind}  ({how})"]
        lines += [f"  {row[0]:{name}}  {row[1]:{package}}  {row[2]}".rstrip() for row in rows]
        lines += [""]
    lines += ["left out:" if left_out else "Nothing was left out."]
    for left in left_out:
        end = "" if left.reason.endswith("?") else "."
        lines += [f"  {left.entry}  ({left.value}, {left.package or 'package unknown'}): {left.reason}{end}"]
    return "\n".join(lines)


def _as_json(
    chosen: Mapping[str, Registry[Any]], settings: Mapping[str, str], left_out: list[LeftOut]
) -> str:
    plugins = [
        {
            "kind": kind,
            "name": cls.__name__,
            "setting": settings.get(kind),
            "class_path": class_path(cls),
            "package": registry.package(cls.__name__),
            "summary": summary(cls),
        }
        for kind, registry in chosen.items()
        for cls in registry
    ]
    left = [
        {
            "name": each.entry,
            "class_path": each.value,
            "group": each.group,
            "package": each.package,
            "reason": each.reason,
        }
        for each in left_out
    ]
    return json.dumps({"plugins": plugins, "left_out": left}, indent=2)
