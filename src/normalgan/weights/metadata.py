"""Metadata of weights files, including our ONNX files."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from normalgan.errors import InputError
from normalgan.hints import HINT_SAMPLERS, HintSampler
from normalgan.line_widths import USUAL_WIDTHS, LineWidths, line_widths_of
from normalgan.models import GENERATORS
from normalgan.version import __version__
from normalgan.weights.class_spec import LARGEST_SETTING, ClassSpec

_UNKNOWN = "null"


@dataclass(frozen=True)
class ModelMetadata:
    """Everything needed to build a model and to test it like the original checkpoint.

    Args:
        generator: class and settings of the generator.
        hint_sampler: hint sampler of the training, needed only for testing; None if it cannot be described
            by plain values.
        size: side of the pictures in pixels.
        noise_at_test: whether the noise stays on in testing and prediction.
        seed: seed of the hints and the noise.
        licence: licence of the weights.
        refined: whether the shipped refiner was trained for this model and sharpens its maps.
        line_widths: thinnest and thickest line of the training drawings, in pixels at the model's
            resolution.
        version: version of normalgan that wrote the file.
    """

    generator: ClassSpec
    hint_sampler: ClassSpec | None
    size: int
    noise_at_test: bool = False
    seed: int = 0
    licence: str = "not stated"
    refined: bool = False
    line_widths: LineWidths = USUAL_WIDTHS
    version: str = __version__

    def metadata(self) -> dict[str, str]:
        """Return the metadata as strings by name, as stored in model files."""
        return {
            "normalgan_version": self.version,
            "model": self.generator.name,
            "licence": self.licence,
            "size": str(self.size),
            "generator": self.generator.to_json(),
            "hint_sampler": self.hint_sampler.to_json() if self.hint_sampler else _UNKNOWN,
            "noise_at_test": str(self.noise_at_test).lower(),
            "seed": str(self.seed),
            "refined": str(self.refined).lower(),
            "line_widths": " ".join(map(str, self.line_widths)),
        }

    def build_hint_sampler(self) -> HintSampler:
        """Return the hint sampler of the training.

        Raises:
            InputError: if its class is unknown here.
        """
        return self._trained_sampler().build(HINT_SAMPLERS)

    def settings(self, measured: bool = True) -> dict[str, Any]:
        """Return the settings of `NormalGAN` in the metadata, as in a configuration.

        Args:
            measured: whether to include the hint sampler of the training, for testing; inference does not
                need it.

        Raises:
            InputError: if a class is unknown here.
        """
        sampler = {"hint_sampler": self._trained_sampler().configuration(HINT_SAMPLERS)} if measured else {}
        return {
            "generator": self.generator.configuration(GENERATORS),
            **sampler,
            "noise_at_test": self.noise_at_test,
            "seed": self.seed,
            "refined": self.refined,
            "line_widths": self.line_widths,
        }

    def _trained_sampler(self) -> ClassSpec:
        if self.hint_sampler is None:
            raise InputError(
                "its hint sampler was made in Python of more than plain values; measure the model there."
            )
        return self.hint_sampler

    @classmethod
    def parse(cls, metadata: Mapping[str, str]) -> "ModelMetadata":
        """Parse the metadata from a file's strings by name.

        Raises:
            KeyError: if an entry is missing.
            InputError: if an entry is invalid.
        """
        return cls(
            ClassSpec.from_json(metadata["generator"]),
            None if metadata["hint_sampler"] == _UNKNOWN else ClassSpec.from_json(metadata["hint_sampler"]),
            size=_number(metadata, "size", LARGEST_SETTING),
            noise_at_test=metadata["noise_at_test"] == "true",
            seed=_number(metadata, "seed", 2**63 - 1),
            licence=metadata["licence"],
            refined=metadata.get("refined") == "true",  # missing in files of older versions
            line_widths=line_widths_of(metadata),
            version=metadata["normalgan_version"],
        )


def _number(metadata: Mapping[str, str], name: str, most: int) -> int:
    text = metadata[name]
    if not (text.isascii() and text.isdecimal() and len(text) < 20 and int(text) <= most):
        raise InputError(f"its {name} is {text[:40]}, not a whole number from 0 to {most}.")
    return int(text)
