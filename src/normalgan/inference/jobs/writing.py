"""Writing: pass the outputs of jobs to a sink, which writes files by default."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple, Self

from normalgan.files.writing import write_bytes
from normalgan.inference.jobs.plan import Job
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.base import Scaled
from normalgan.inference.outputs.output_set import Outputs

Sink = Callable[[Path, bytes], None]
"""Called with the path and the content of each file. The default, `write_bytes`, writes atomically."""


@dataclass(frozen=True)
class MissingFiles:
    """A sink that writes only files that do not exist.

    Args:
        sink: writes the missing files.
        kept: gets the paths of the files that exist.
    """

    sink: Sink
    kept: set[Path] = field(default_factory=set)

    def __call__(self, path: Path, content: bytes) -> None:
        """Write a file unless it exists."""
        if path.exists():
            self.kept.add(path)
        else:
            self.sink(path, content)


class Held(NamedTuple):
    """A file that is held back until the scale that it shares with other files is known."""

    path: Path
    content: Scaled


@dataclass(frozen=True)
class Done:
    """The result of a job.

    Args:
        maps: paths of the maps, one for each frame or layer that is written to its own file.
        warning: warning as part of a sentence; empty if there is none.
        note: remark for the user as part of a sentence; empty if there is none.
        partial: whether something in the drawing could not be predicted; the warning says what.
    """

    maps: list[Path]
    warning: str = ""
    note: str = ""
    partial: bool = False


@dataclass(frozen=True)
class Writer:
    """Writes the outputs of jobs, and holds back those whose scale depends on other drawings.

    Args:
        outputs: the outputs to write.
        sink: called with each file.
        held: the files that are held back; `write_held` writes them.
    """

    outputs: Outputs = field(default_factory=Outputs)
    sink: Sink = write_bytes
    held: list[Held] = field(default_factory=list)

    def apart(self) -> Self:
        """Return a writer of the same files that holds back none yet."""
        return replace(self, held=[])

    def write(self, job: Job, preds: NormalMap, hold: bool = False) -> None:
        """Write the files of a drawing.

        Args:
            job: job of the drawing.
            preds: map of the drawing.
            hold: whether the drawing shares its scale with others, like the frames of an animation.

        Raises:
            OSError: if a file cannot be written.
        """
        own = self.apart()
        own.write_others(job, preds, hold)
        self.write_map(job, preds)  # last, so that an existing map implies that its other outputs exist
        self.held.extend(own.held)

    def write_others(self, job: Job, preds: NormalMap, hold: bool = False) -> None:
        """Write all files except the map; the arguments are those of `write`."""
        for ending, content in self.outputs.encode_others(preds):
            if isinstance(content, Scaled) and (hold or self.outputs.whole_batch):
                self.held.append(Held(job.path_with(ending), content))
            else:
                self.sink(job.path_with(ending), content)

    def write_map(self, job: Job, preds: NormalMap) -> None:
        """Write only the map and the engine's import file."""
        self.write_sidecar(job.target)
        (content,) = self.outputs.normal.encode(preds).values()
        self.sink(job.target, content)

    def write_sidecar(self, target: Path) -> None:
        """Write the engine's import file for a map, unless it exists.

        An existing import file of Unity or Godot holds the id that scenes refer to, and possibly changed
        settings.
        """
        # The id depends on the absolute path, because two folders may each have a normals/fox_NormalMap.png.
        found = self.outputs.normal.sidecar(target.absolute())
        if found is not None and (found[0].suffix == ".py" or not found[0].exists()):
            self.sink(*found)

    def write_held(self) -> None:
        """Write all held files at one scale, the largest among them.

        Raises:
            OSError: if a file cannot be written.
        """
        most = max((content.spread for _, content in self.held), default=0.0)
        for path, content in self.held:
            self.sink(path, content.at(most))
        self.held.clear()
