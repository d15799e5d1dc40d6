"""Writing: pass the outputs of jobs to a sink, which writes files by default."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

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
class Writer:
    """Writes the outputs of jobs.

    Args:
        outputs: the outputs to write.
        sink: called with each file.
    """

    outputs: Outputs = field(default_factory=Outputs)
    sink: Sink = write_bytes

    def write(self, job: Job, preds: NormalMap, hold: bool = False) -> list[Held]:
        """Write the files of a drawing; return the files that are held back for other drawings.

        Args:
            job: job of the drawing.
            preds: map of the drawing.
            hold: whether the drawing shares its scale with others, like the frames of an animation.

        Raises:
            OSError: if a file cannot be written.
        """
        held = self.write_others(job, preds, hold)
        self.write_map(job, preds)  # last, so that an existing map implies that its other outputs exist
        return held

    def write_others(self, job: Job, preds: NormalMap, hold: bool = False) -> list[Held]:
        """Write all files except the map; return the files that are held back for other drawings.

        Args:
            job: job of the drawing.
            preds: map of the drawing.
            hold: whether the drawing shares its scale with others, like the frames of an animation.
        """
        held = []
        for ending, content in self.outputs.encode_others(preds):
            if isinstance(content, Scaled) and (hold or self.outputs.whole_batch):
                held.append(Held(job.path_with(ending), content))
            else:
                self.sink(job.path_with(ending), content)
        return held

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

    def write_held(self, held: Sequence[Held]) -> None:
        """Write all held files at one scale, the largest among them.

        Raises:
            OSError: if a file cannot be written.
        """
        most = max((content.spread for _, content in held), default=0.0)
        for path, content in held:
            self.sink(path, content.at(most))
