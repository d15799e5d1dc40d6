"""Outputs: the normal map and all other files of a drawing."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

from normalgan.errors import InputError
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.base import OUTPUTS, Output
from normalgan.inference.outputs.normal import Normal


@dataclass(frozen=True)
class Outputs:
    """The files that are written for each drawing.

    Args:
        normal: settings of the normal map.
        others: all other outputs.
    """

    normal: Normal = field(default_factory=Normal)
    others: tuple[Output, ...] = ()

    @property
    def ending(self) -> str:
        """The ending of a normal map's name, such as ``_normal.png``."""
        return self.normal.endings[0]

    @property
    def other_endings(self) -> list[str]:
        """The endings of all other files, such as ``_height.png``."""
        return [ending for output in self.others for ending in output.endings]

    @property
    def whole_batch(self) -> bool:
        """Whether some files depend on all drawings of a command."""
        return any(output.whole_batch for output in self.others)

    def encode_others(self, preds: NormalMap) -> Iterator[tuple[str, bytes]]:
        """Yield the ending and content of every file except the normal map's."""
        once = replace(preds)  # a temporary copy, which caches the heights for all outputs
        for output in self.others:
            yield from output.encode(once).items()


def option_of(kind: type[Output]) -> str:
    """Return the command-line option that selects an output."""
    return kind.option or kind.name


def settings_of(kind: type[Output]) -> list[str]:
    """Return the names of an output's settings that are separate options."""
    return [each.name for each in fields(kind) if each.name != "format"]


def outputs_of(settings: Mapping[str, Any]) -> Outputs:
    """Return the outputs that a command's options select.

    Args:
        settings: value of each option of every output in `OUTPUTS`, and of the options of `Normal` that the
            command has.

    Raises:
        InputError: if the settings contradict each other.
    """
    others = []
    for kind in OUTPUTS:
        option, formats = option_of(kind), kind.formats()
        own = {name: settings[name] for name in settings_of(kind)}
        asked = settings[option]
        if asked:
            others.append(kind(**own, format=asked if len(formats) > 1 else formats[0]))
            continue
        for each in fields(kind):
            if each.name in own and own[each.name] != each.default:
                flag = f"--{option.replace('_', '-')}{' ' + formats[0] if len(formats) > 1 else ''}"
                raise InputError(
                    f"--{each.name.replace('_', '-')} is a setting of the {kind.label.lower()}; "
                    f"add {flag}, or leave it out."
                )
    own = {each.name: settings.get(each.name) for each in fields(Normal)}
    normal = {name: value for name, value in own.items() if value is not None}  # None stands for the default
    return Outputs(Normal(**normal), tuple(others))
