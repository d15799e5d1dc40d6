"""The two interfaces of a data set: sources that can be loaded, and a recipe that makes samples of them."""

from typing import Any, Protocol, runtime_checkable

from normalgan.errors import InputError
from normalgan.rendering.samples import Sample

__all__ = ["Loadable", "SampleRecipe", "fingerprint"]


@runtime_checkable
class Loadable(Protocol):
    """A source of samples, such as a mesh or a pair; cheap to keep and to send to a worker."""

    @property
    def name(self) -> str:
        """Its name, unique in the data set."""

    def fingerprint(self) -> str:
        """Return a hash of everything that `load` depends on: bytes of files, settings, a version.

        Raises:
            InputError: if it cannot be computed.
        """

    def load(self) -> Any:
        """Return the object that the recipe makes samples of, such as a `Mesh` or a `Pair`.

        Raises:
            InputError: if it cannot be used; the message says why, and it is left out with a warning.
        """


class SampleRecipe(Protocol):
    """How to make samples of loaded objects; samples do not depend on the order in which they are made."""

    @property
    def noun(self) -> str:
        """The word for a source in messages: ``mesh`` or ``pair``."""

    @property
    def size(self) -> int:
        """Side of the pictures in pixels."""

    @property
    def hints(self) -> bool:
        """Whether its samples bring hints."""

    def check(self) -> None:
        """Raise `InputError` if this machine lacks a requirement of the recipe."""

    def render(self, loaded: Any, index: int, /) -> Sample:
        """Return sample number ``index`` of a mesh or pair; it does not depend on the other samples.

        Raises:
            InputError: if it cannot be made.
        """

    def describe(self) -> dict[str, Any]:
        """Return all settings that the samples depend on, as plain values for JSON.

        ``rendering_version`` among them is the version of the code that makes them.
        """


def fingerprint(source: Loadable) -> str:
    """Return the fingerprint of a source; an unreadable one has one too, and fails on loading."""
    try:
        return source.fingerprint()
    except InputError as error:
        return f"none: {error}"
