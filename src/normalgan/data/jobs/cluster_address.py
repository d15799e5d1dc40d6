"""Connect to a cluster by its address or file."""

import importlib
import logging
import re
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from typing import Any

import yaml

from normalgan.data.jobs.workers import one_thread_each
from normalgan.data.store.storage import reason
from normalgan.errors import InputError
from normalgan.files.limits import MOST_SETTINGS, load_yaml, read_bounded, yaml_limit_error
from normalgan.warning_filters import quiet_loggers

__all__ = ["TIMEOUT", "connect", "read_cluster"]

TIMEOUT = 10.0
"""Seconds in which a scheduler must answer."""

_FORMS = "tcp://host:port, a scheduler file (.json), local:N or a YAML file that names a cluster class"
_KEYS = {"class_path", "init_args", "scale", "adapt", "patience"}
_PATIENCE = 60.0
_LOCAL = {
    # A mesh that kills is tried again alone, so a second death is enough here, instead of a fourth.
    "distributed.scheduler.allowed-failures": 1,
    # LocalCluster gives a worker up for good that is not back in time; on a busy machine 15 s are too few.
    "distributed.deploy.lost-worker-timeout": "10 minutes",
}


def connect(where: str, stack: ExitStack) -> tuple[Any, float]:
    """Return a client of the cluster, and the seconds to wait while it has no worker at all.

    Args:
        where: ``tcp://host:port``; a scheduler file ``….json``; ``local:N`` for N processes of this machine;
            or ``….yaml`` with ``class_path`` and ``init_args`` of a class of Dask clusters, and if wanted
            ``scale`` or ``adapt`` with the arguments of its methods of these names, and ``patience`` in
            seconds, if the first worker may take longer than a minute to come.
        stack: ends what is started here.

    Raises:
        InputError: if Dask is not installed, it is none of these, or no scheduler answers.
    """
    try:
        import dask.config
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise InputError("a cluster needs Dask: pip install 'normalgan[cluster]'.") from error
    stack.enter_context(_quiet_dask())
    address: Any = where
    patience, settings = _PATIENCE, {}
    if found := re.fullmatch(r"local:(\d+)", where):
        if int(found[1]) < 1:
            raise InputError(f"the cluster {where} has no worker; local:2 has two.")
        stack.enter_context(dask.config.set(_LOCAL))
        with one_thread_each():
            made: Any = LocalCluster(  # type: ignore[no-untyped-call]
                n_workers=int(found[1]), threads_per_worker=1, processes=True, dashboard_address=":0"
            )
        address = stack.enter_context(made)
    elif where.endswith((".yaml", ".yml")):
        content = read_cluster(Path(where))
        patience = float(content.get("patience", _PATIENCE))
        address = _make(where, content, stack)
    elif where.endswith(".json"):
        if not Path(where).is_file():
            raise InputError(
                f"there is no scheduler file {where}; dask scheduler --scheduler-file writes it."
            )
        address, settings = None, {"scheduler_file": where}
    elif not re.fullmatch(r"(\w+://)?[^/\s]+:\d+", where):
        raise InputError(f"{where!r} names no cluster; give {_FORMS}.")
    return stack.enter_context(_client(Client, address, where, settings)), patience


def _client(client: Callable[..., Any], address: Any, where: str, settings: dict[str, str]) -> Any:
    try:
        return client(address, timeout=TIMEOUT, set_as_default=False, **settings)
    except (OSError, ValueError) as error:  # no answer; no such protocol, no scheduler file
        raise InputError(
            f"no scheduler answers at {where} within {TIMEOUT:.0f} seconds ({reason(error)}); is it running, "
            "and is the address right?"
        ) from error


def _quiet_dask() -> AbstractContextManager[None]:
    """Keep Dask from telling what we tell in a sentence, or what is no matter: that a worker has gone."""
    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] == "distributed"]
    return quiet_loggers(*names)


def read_cluster(file: Path) -> dict[str, Any]:
    """Return what a YAML file says of a cluster; see `connect`.

    Raises:
        InputError: if it cannot be read, wants too much, or does not name a class.
    """
    try:
        text = read_bounded(file, MOST_SETTINGS).decode("utf-8")
        if excess := yaml_limit_error(text):
            raise InputError(f"the cluster file {file} {excess}; a cluster needs no such thing.")
        content = load_yaml(text)
    except (OSError, yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError(f"the cluster file {file} cannot be read: {reason(error)}.") from error
    if not isinstance(content, dict) or "class_path" not in content or set(content) - _KEYS:
        raise InputError(
            f"the cluster file {file} must hold class_path and may hold init_args, scale, adapt and "
            "patience, and nothing else."
        )
    patience = content.get("patience", _PATIENCE)
    if type(patience) not in {int, float} or not 0 <= patience < float("inf"):
        raise InputError(f"patience in the cluster file {file} is {patience!r}; give seconds, such as 3600.")
    return content


def _make(file: str, content: dict[str, Any], stack: ExitStack) -> Any:
    """Return the cluster that a YAML file describes; ``stack`` ends it."""
    path = str(content["class_path"])
    kind = _cluster_class(file, path)
    try:
        cluster = stack.enter_context(kind(**(content.get("init_args") or {})))
        for method in ("scale", "adapt"):
            if method in content:
                getattr(cluster, method)(**content[method])
    except Exception as error:  # whatever a queue or a cloud answers
        raise InputError(f"{path} in the cluster file {file} cannot be started: {reason(error)}.") from error
    return cluster


def _cluster_class(file: str, path: str) -> Callable[..., Any]:
    """Return the class of clusters that a file names, of any package: a cluster file is a program.

    Raises:
        InputError: if it is none, or cannot be imported.
    """
    from distributed import SSHCluster
    from distributed.deploy.cluster import Cluster

    module, _, name = path.rpartition(".")
    try:
        kind = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError, ValueError) as error:
        raise InputError(f"{path} in the cluster file {file} cannot be imported: {reason(error)}.") from error
    if kind is not SSHCluster and not (isinstance(kind, type) and issubclass(kind, Cluster)):
        raise InputError(f"{path} in the cluster file {file} is no class of Dask clusters.")
    made: Callable[..., Any] = kind
    return made
