"""Output: the base of all kinds of files that are written for a drawing, and their registry."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, get_args, get_type_hints

import numpy as np

from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.engines import Engine
from normalgan.normals import encode_grey
from normalgan.ranges import check_ranges
from normalgan.registry import Registry

__all__ = ["OUTPUTS", "Output", "Scaled"]


@dataclass(frozen=True)
class Output(ABC):
    """A kind of file that is written next to a normal map, such as a height map.

    Subclasses are frozen dataclasses. Each field is a setting with a default, and an option of `generate` and
    `predict`, so its name must be new to both. The studio's menu also reads the registry, and so does the
    rule that tells outputs from drawings.

    Args:
        format: ending of the file. A kind with several annotates it as a `Literal` of them.
    """

    name: ClassVar[str]
    """What its files are called: ``height`` stands for ``fox_height.png``."""
    label: ClassVar[str]
    """What the studio's menu calls it."""
    option: ClassVar[str] = ""
    """The option of the commands that asks for it; empty is its name."""
    in_zip: ClassVar[bool] = True
    """Whether the studio's zip of all files holds it."""
    engine_suffixes: ClassVar[Mapping[Engine, str]] = {}
    """Suffixes in the zip for an engine, such as ``{"unity": "_Occlusion"}``; elsewhere ``_name``."""
    engine_formats: ClassVar[Mapping[Engine, str]] = {}
    """Formats in the zip for an engine; elsewhere the default format."""

    format: str = "png"

    def __post_init__(self) -> None:
        """Check the settings; a subclass that overrides it calls it first."""
        check_ranges(self)

    @abstractmethod
    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of each file, by its ending; the endings are `endings`.

        Args:
            preds: the map of a drawing. Its `height` is computed once for all outputs.
        """

    @property
    def endings(self) -> tuple[str, ...]:
        """The endings of its file names, after the drawing's name, such as ``_height.png``."""
        return (f"_{self.name}.{self.format}",)

    @property
    def whole_batch(self) -> bool:
        """Whether its files depend on all drawings of a command."""
        return False

    @classmethod
    def zip_suffix(cls, engine: Engine | None) -> str:
        """Return what follows a drawing's name in the zip for an engine, such as ``_height``."""
        plain = f"_{cls.name}"
        return plain if engine is None else cls.engine_suffixes.get(engine, plain)

    @classmethod
    def formats(cls) -> tuple[str, ...]:
        """Return the formats it can have, the default first."""
        return get_args(get_type_hints(cls)["format"]) or (cls.format,)


class Scaled(bytes):
    """A 16-bit grey PNG with a known scale, so that it can be rescaled to match others.

    Args:
        content: content of the file.
        spread: what white stands for.
    """

    spread: float

    def __new__(cls, content: bytes, spread: float) -> "Scaled":
        """Keep the scale with the content."""
        scaled = super().__new__(cls, content)
        scaled.spread = spread
        return scaled

    def at(self, spread: float) -> bytes:
        """Return the file rescaled so that white means ``spread``, which is at least its own."""
        if spread <= self.spread:
            return self
        import cv2

        levels: Any = cv2.imdecode(np.frombuffer(self, np.uint8), cv2.IMREAD_UNCHANGED)
        return encode_grey(np.asarray(levels * (self.spread / spread / 65535), np.float32), ".png", 16)


OUTPUTS: Registry[Output] = Registry(Output, "normalgan.outputs")  # type: ignore[type-abstract]
"""The outputs that can be asked for by name; the normal map itself is always written."""
