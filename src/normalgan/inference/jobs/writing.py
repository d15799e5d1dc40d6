"""Writing: the outputs of a job go to its sink, which is files by default."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from normalgan.files.writing import write_bytes
from normalgan.inference.jobs.plan import Job
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.base import Scaled
from normalgan.inference.outputs.output_set import Outputs

__all__ = ["Held", "Sink", "Writer"]

Sink = Callable[[Path, bytes], None]
"""Takes a file: its path and its content. `write_bytes` writes it whole or not at all."""


class Held(NamedTuple):
    """A file that waits for the scale that it shares with others."""

    path: Path
    content: Scaled


@dataclass(frozen=True)
class Writer:
    """Writes the outputs of jobs.

    Args:
        outputs: what is written.
        sink: where each file goes.
    """

    outputs: Outputs = field(default_factory=Outputs)
    sink: Sink = write_bytes

    def write(self, job: Job, preds: NormalMap) -> list[Held]:
        """Write the files of a drawing; return those that wait for other drawings.

        Raises:
            OSError: if a file cannot be written.
        """
        held = self.write_others(job, preds)
        self.write_map(job, preds)  # last, so that where there is a map, there is the rest too
        return held

    def write_others(self, job: Job, preds: NormalMap, hold: bool = False) -> list[Held]:
        """Write all but the map; return what waits for other drawings.

        Args:
            job: the drawing.
            preds: its map.
            hold: whether the drawing shares its scale with others, such as the frames of an animation.
        """
        held = []
        for ending, content in self.outputs.encode_others(preds):
            if isinstance(content, Scaled) and (hold or self.outputs.whole_batch):
                held.append(Held(job.beside(ending), content))
            else:
                self.sink(job.beside(ending), content)
        return held

    def write_map(self, job: Job, preds: NormalMap) -> None:
        """Write only the map and the engine's import file."""
        self.write_sidecar(job.target)
        (content,) = self.outputs.normal.encode(preds).values()
        self.sink(job.target, content)

    def write_sidecar(self, target: Path) -> None:
        """Write the file by which an engine imports a map, unless it exists.

        An existing file of Unity or Godot holds the id that scenes refer to, and perhaps changed settings.
        """
        # Of the whole path: two folders may each have a normals/fox_NormalMap.png, and their ids must differ.
        found = self.outputs.normal.sidecar(target.absolute())
        if found is not None and (found[0].suffix == ".py" or not found[0].exists()):
            self.sink(*found)

    def write_held(self, held: Sequence[Held]) -> None:
        """Write files with one scale for all: the largest of all.

        Raises:
            OSError: if one cannot be written.
        """
        most = max((content.spread for _, content in held), default=0.0)
        for path, content in held:
            self.sink(path, content.at(most))
