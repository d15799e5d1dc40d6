"""Output: base class and registry of the kinds of files written for a drawing."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, get_args, get_type_hints

import numpy as np

from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.engines import Engine
from normalgan.normals import encode_grey
from normalgan.ranges import RangeChecked
from normalgan.registry import Registry


@dataclass(frozen=True)
class Output(RangeChecked, ABC):
    """A kind of file that is written next to a normal map, such as a height map.

    Subclasses are frozen dataclasses. Each field is a setting with a default and becomes an option of
    `generate` and `predict`, so its name must not clash with theirs. The registry also fills the studio's
    export menu and tells which files in a folder are outputs, not drawings. A new kind in this package is a
    module in this folder, which is imported by itself; ``examples/plugins/output.py`` is a whole one to copy.

    Args:
        format: file ending. A kind with several formats annotates it as a `Literal`.
    """

    name: ClassVar[str]
    """Name of the kind in file names: ``height`` gives ``fox_height.png``."""
    label: ClassVar[str]
    """Label in the studio's menu."""
    option: ClassVar[str] = ""
    """Command-line option that selects the kind; if empty, the name is used."""
    in_zip: ClassVar[bool] = True
    """Whether the studio's zip of all files contains the kind."""
    engine_suffixes: ClassVar[Mapping[Engine, str]] = {}
    """File name suffixes in an engine's zip, such as ``{"unity": "_Occlusion"}``; by default ``_name``."""
    engine_formats: ClassVar[Mapping[Engine, str]] = {}
    """File formats in an engine's zip; by default the first of `formats`."""

    format: str = "png"

    @abstractmethod
    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of each file by its ending; see `endings`.

        Args:
            preds: map of the drawing. Its `height` is computed once for all outputs. If it has ``cells`` or
                a ``tile``, an output that looks beyond single pixels treats each cell separately and wraps
                around the edges, as `normalgan.inference.outputs.shading` does.
        """

    @property
    def endings(self) -> tuple[str, ...]:
        """The endings that follow the drawing's name in file names, such as ``_height.png``."""
        return (f"_{self.name}.{self.format}",)

    @property
    def whole_batch(self) -> bool:
        """Whether the files depend on all drawings of a command."""
        return False

    @classmethod
    def zip_suffix(cls, engine: Engine | None) -> str:
        """Return the file name suffix in an engine's zip, such as ``_height``."""
        plain = f"_{cls.name}"
        return plain if engine is None else cls.engine_suffixes.get(engine, plain)

    @classmethod
    def formats(cls) -> tuple[str, ...]:
        """Return the supported formats, the default first."""
        return get_args(get_type_hints(cls)["format"]) or (cls.format,)


class Scaled(bytes):
    """A 16-bit grey PNG with a known scale, so that it can be rescaled to match other files.

    Args:
        content: content of the file.
        spread: value that white stands for.
    """

    spread: float

    def __new__(cls, content: bytes, spread: float) -> "Scaled":
        """Create the bytes and attach the scale."""
        scaled = super().__new__(cls, content)
        scaled.spread = spread
        return scaled

    def at(self, spread: float) -> bytes:
        """Return the file rescaled so that white means ``spread``, which must be at least the file's own."""
        if spread <= self.spread:
            return self
        import cv2

        levels: Any = cv2.imdecode(np.frombuffer(self, np.uint8), cv2.IMREAD_UNCHANGED)
        return encode_grey(np.asarray(levels * (self.spread / spread / 65535), np.float32), ".png", 16)


OUTPUTS: Registry[Output] = Registry(Output, "normalgan.outputs")  # type: ignore[type-abstract]
"""The outputs that can be selected by name; the normal map itself is always written."""
