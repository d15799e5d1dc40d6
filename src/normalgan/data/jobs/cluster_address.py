"""Connect to a cluster by its address or its scheduler's file."""

import logging
import re
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from typing import Any

from normalgan.data.jobs.workers import one_thread_each
from normalgan.data.store.storage import reason
from normalgan.errors import InputError
from normalgan.warning_filters import quiet_loggers

__all__ = ["TIMEOUT", "connect"]

TIMEOUT = 10.0
"""Seconds in which a scheduler must answer."""

_FORMS = "tcp://host:port, a scheduler file (.json) or local:N"
_LOCAL = {
    # A mesh that kills is tried again alone, so two deaths are enough, not Dask's four.
    "distributed.scheduler.allowed-failures": 1,
    # LocalCluster gives up a worker that is not back in time; 15 s are too few on a busy machine.
    "distributed.deploy.lost-worker-timeout": "10 minutes",
}


def connect(where: str, stack: ExitStack) -> Any:
    """Return a client of the cluster.

    Args:
        where: ``tcp://host:port``; a scheduler file ``….json``; or ``local:N`` for N processes of this
            machine.
        stack: closes the client and a local cluster when it ends.

    Raises:
        InputError: if Dask is not installed, the address has none of these forms, or no scheduler answers.
    """
    try:
        import dask.config
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise InputError("a cluster needs Dask: pip install 'normalgan[cluster]'.") from error
    stack.enter_context(_quiet_dask())
    address: Any = where
    settings: dict[str, str] = {}
    if found := re.fullmatch(r"local:(\d+)", where):
        if int(found[1]) < 1:
            raise InputError(f"the cluster {where} has no worker; local:2 has two.")
        stack.enter_context(dask.config.set(_LOCAL))
        with one_thread_each():
            made: Any = LocalCluster(  # type: ignore[no-untyped-call]
                n_workers=int(found[1]), threads_per_worker=1, processes=True, dashboard_address=":0"
            )
        address = stack.enter_context(made)
    elif where.endswith(".json"):
        if not Path(where).is_file():
            raise InputError(
                f"there is no scheduler file {where}; dask scheduler --scheduler-file writes it."
            )
        address, settings = None, {"scheduler_file": where}
    elif not re.fullmatch(r"(\w+://)?[^/\s]+:\d+", where):
        raise InputError(f"{where!r} names no cluster; give {_FORMS}.")
    return stack.enter_context(_client(Client, address, where, settings))


def _client(client: Callable[..., Any], address: Any, where: str, settings: dict[str, str]) -> Any:
    try:
        return client(address, timeout=TIMEOUT, set_as_default=False, **settings)
    except (OSError, ValueError) as error:  # no answer; no such protocol, no scheduler file
        raise InputError(
            f"no scheduler answers at {where} within {TIMEOUT:.0f} seconds ({reason(error)}); is it running, "
            "and is the address right?"
        ) from error


def _quiet_dask() -> AbstractContextManager[None]:
    """Silence Dask where we report the event or it does not matter: that a worker has gone."""
    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] == "distributed"]
    return quiet_loggers(*names)
