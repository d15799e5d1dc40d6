"""Tiny data sets: rendered in seconds, and compared byte for byte."""

from dataclasses import dataclass
from pathlib import Path

from moments import Moment
from nursery import Child, rear
from toys import contents

from five_meshes import write_meshes

CONF = Path(__file__).parents[2] / "tests" / "conf"


@dataclass(frozen=True)
class TinySet:
    """Five solids at 32 pixels, in nine shards, in a cache of its own.

    Args:
        work: folder that such sets share: meshes, logs.
        name: of this one.
    """

    work: Path
    name: str

    @property
    def cache(self) -> Path:
        """Where it is rendered to."""
        return self.work / self.name

    def render(self, workers: int, moment: Moment | None = None, fresh: bool = False) -> Child:
        """Render what is not there yet."""
        meshes = self.work / "meshes"
        if not meshes.exists():
            meshes.mkdir(parents=True)
            write_meshes(meshes)
        arguments = (
            *("render", "--config", CONF / "tiny.yaml", "--data.meshes", meshes, "--data.cache", self.cache),
            *("--data.lines", "OccludingContours", "--data.lines.resolution", 64),
            *("--data.render_workers", workers),
            *("--data.train_views", 44, "--data.val_views", 33, "--data.test_views", 33),
        )
        log = self.work / f"{self.name}.log"
        return rear([*map(str, arguments)], self.cache, log, moment, fresh)

    def finished(self) -> dict[str, int]:
        """Return when each shard was finished, by its marker."""
        markers = self.cache.glob("*/done/*/*.json")
        return {str(path.relative_to(self.cache)): path.stat().st_mtime_ns for path in markers}

    @property
    def files(self) -> int:
        """How many files there are, half-written ones too."""
        return sum(path.is_file() for path in self.cache.rglob("*"))

    def left(self) -> list[Path]:
        """Return what is half written."""
        return [path for path in self.cache.rglob("*") if path.is_file() and ".partial" in path.parts]

    def differences(self, other: "TinySet") -> list[str]:
        """Return what is not as in another set, and what is half written."""
        mine, theirs = contents(self.cache), contents(other.cache)
        names = [name for name in sorted({*mine, *theirs}) if mine.get(name) != theirs.get(name)]
        return [f"{name} differs" for name in names] + [f"{path.name} is left" for path in self.left()]
