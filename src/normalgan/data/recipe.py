"""The two interfaces of a data set: loadable sources, and a recipe that turns them into samples."""

from typing import Any, Protocol, runtime_checkable

from normalgan.errors import InputError
from normalgan.rendering.samples import Sample


@runtime_checkable
class Loadable(Protocol):
    """A source of samples, such as a mesh or a pair, that is cheap to keep and to send to a worker."""

    @property
    def name(self) -> str:
        """Name of the source, unique in the data set."""

    def fingerprint(self) -> str:
        """Return a hash of everything that `load` depends on: file contents, settings, a version.

        Raises:
            InputError: if the hash cannot be computed.
        """

    def load(self) -> Any:
        """Return the object for the recipe, such as a `Mesh` or a `Pair`.

        Raises:
            InputError: if the source cannot be used. It is then left out, with a warning that shows the
                message.
        """


class SampleRecipe(Protocol):
    """Recipe that turns loaded objects into samples, which must not depend on the order of creation."""

    @property
    def noun(self) -> str:
        """Word for a source in messages: ``mesh`` or ``pair``."""

    @property
    def size(self) -> int:
        """Side of the pictures in pixels."""

    @property
    def hints(self) -> bool:
        """Whether the samples have hints."""

    def check(self) -> None:
        """Raise `InputError` if this machine lacks a requirement of the recipe."""

    def render(self, loaded: Any, index: int, /) -> Sample:
        """Return the sample of a mesh or pair at an index; it must not depend on other samples.

        Raises:
            InputError: if the sample cannot be created.
        """

    def describe(self) -> dict[str, Any]:
        """Return all settings that the samples depend on, as plain values for JSON.

        They include ``rendering_version``, the version of the code that creates samples.
        """


def fingerprint(source: Loadable) -> str:
    """Return the fingerprint of a source, even of an unreadable one, which fails later on loading."""
    try:
        return source.fingerprint()
    except InputError as error:
        return f"none: {error}"
