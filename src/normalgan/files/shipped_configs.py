"""Shipped configurations: the configuration files that come with the package, by name."""

from pathlib import Path


def shipped_folder() -> Path:
    """Return the folder of the shipped configurations, in the installed package or in the clone."""
    packed = Path(__file__).parents[1] / "configs"
    return packed if packed.is_dir() else Path(__file__).parents[3] / "configs"


def shipped_names() -> list[str]:
    """Return the names of the shipped configurations, such as ``paper`` and ``fourleg/meshes``."""
    folder = shipped_folder()
    return sorted(path.relative_to(folder).with_suffix("").as_posix() for path in folder.rglob("*.yaml"))


def find_beside(given: str) -> Path:
    """Return the path of a file named in a configuration: the user's file if it exists, else the package's.

    Args:
        given: path relative to the working directory, such as ``configs/fourleg/split.json``.
    """
    path = Path(given)
    shipped = shipped_folder().joinpath(*path.parts[1:])
    ours = path.parts[:1] == ("configs",) and not path.exists() and shipped.is_file()
    return shipped if ours else path


def find_config(given: str) -> str:
    """Return the path of a configuration: the given file if it exists, else a shipped configuration.

    Args:
        given: path, or a name such as ``paper``; ``configs/paper.yaml`` works too.
    """
    name = Path(given).as_posix().removeprefix("configs/").removesuffix(".yaml")
    if Path(given).exists() or name not in shipped_names():
        return given
    return str(shipped_folder() / f"{name}.yaml")
