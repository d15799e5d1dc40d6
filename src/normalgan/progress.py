"""Progress bars on the error stream."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def progress_bar(
    title: str, total: int, unit: str, shown: bool = True, stays: bool = True
) -> Iterator[Callable[[int], None]]:
    """Show a bar, and yield a function that advances it.

    Args:
        title: label of the bar.
        total: number of units.
        unit: name of the units.
        shown: whether the bar is shown at all.
        stays: whether the finished bar stays on the screen, or as one line in a log file.
    """
    if not shown or total <= 0:
        yield lambda more: None
        return
    # Imported here because most commands show no bar.
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn(title), BarColumn(), MofNCompleteColumn(), TextColumn(unit), TimeRemainingColumn())
    console = Console(stderr=True)
    seen = stays or console.is_terminal  # a file would get an empty line
    with Progress(*columns, console=console, transient=not stays, disable=not seen) as bar:
        task = bar.add_task("", total=total)
        yield lambda more: bar.advance(task, more)
