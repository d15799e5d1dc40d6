"""Limits on memory, time and files of the child process."""

import sys


def limit(memory: int) -> None:
    """Forbid this process from opening files, and limit its memory."""
    try:
        import resource
    except ImportError:  # Windows has no equivalent
        return
    # From here on, no decoder can open a file, socket or pipe.
    for what in (resource.RLIMIT_CORE, resource.RLIMIT_FSIZE):
        _lower(what, 0)
    if sys.platform == "linux":  # macOS ignores it
        with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123 -- nothing else can be imported
            mapped = int(file.read().split()[0]) * resource.getpagesize()
        _lower(resource.RLIMIT_AS, mapped + memory)
    _lower(resource.RLIMIT_NOFILE, 0)


def limit_time(seconds: int) -> None:
    """Limit the processor time for the next picture, after which the system ends this process."""
    if sys.platform == "win32":
        return
    import resource

    used = resource.getrusage(resource.RUSAGE_SELF)
    until = int(used.ru_utime + used.ru_stime) + 1 + seconds
    hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
    resource.setrlimit(
        resource.RLIMIT_CPU, (until if hard == resource.RLIM_INFINITY else min(until, hard), hard)
    )


def _lower(what: int, most: int) -> None:
    """Set a limit of this process, unless a lower one is in effect."""
    import resource

    hard = resource.getrlimit(what)[1]
    most = most if hard == resource.RLIM_INFINITY else min(most, hard)
    resource.setrlimit(what, (most, most))
