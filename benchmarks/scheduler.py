"""What a Dask scheduler costs: tasks that do nothing, at a fixed rate, handed out as `Cluster` does it.

    python benchmarks/scheduler.py -o docs/results/scheduler.json

Scheduler and workers are processes of their own. A task's latency is the time from handing it out to hearing
of its end: what a shard takes beyond the work itself. The scheduler's share is its CPU time over the time
that passed, of one core. Where fewer tasks are done than handed out, one of the three is at its limit.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from queue import SimpleQueue
from statistics import quantiles
from typing import Any

import psutil
from distributed import Client
from machine import ONE_THREAD, describe

RATES = (10, 100, 1000)
_WORK = bytes(4000)
"""As long as the order of a shard of 32 samples of two meshes."""


def start(*arguments: str) -> psutil.Popen:
    """Start a part of Dask."""
    return psutil.Popen(
        [sys.executable, "-m", "dask", *arguments, "--no-dashboard"],
        env={**os.environ, **ONE_THREAD},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def cpu_seconds(process: psutil.Popen) -> float:
    """Return the CPU time that a process has used."""
    times = process.cpu_times()
    return float(times.user + times.system)


def measure(client: Client, scheduler: psutil.Popen, rate: int, seconds: float) -> dict[str, float]:
    """Hand out tasks at a rate and return what came of it.

    Args:
        client: connected.
        scheduler: its process.
        rate: tasks a second.
        seconds: for how long.
    """
    ended: SimpleQueue[tuple[Any, float]] = SimpleQueue()

    def note(future: Any) -> None:
        ended.put((future.key, time.perf_counter()))

    begun: dict[Any, float] = {}
    under_way: dict[Any, Any] = {}
    latencies: list[float] = []
    start, used, late = time.perf_counter(), cpu_seconds(scheduler), 0.0
    total = round(rate * seconds)
    while len(latencies) < total:
        due = start + len(begun) / rate
        now = time.perf_counter()
        if len(begun) < total and now >= due:
            late = max(late, now - due)
            key = f"nothing-{rate}-{len(begun)}"
            begun[key] = now
            under_way[key] = client.submit(eval, "None", {"work": _WORK}, key=key, pure=False)
            under_way[key].add_done_callback(note)
        while not ended.empty():
            key, end = ended.get()
            del under_way[key]  # forgotten by the scheduler, as `Cluster` does
            latencies.append(end - begun[key])
        time.sleep(max(0.0, min(due - now, 0.001)))
    wall = time.perf_counter() - start
    cuts = quantiles(latencies, n=20)
    return {
        "rate": rate,
        "done_per_s": round(total / wall, 1),
        "latency_p50_ms": round(1000 * cuts[9], 1),
        "latency_p95_ms": round(1000 * cuts[18], 1),
        "scheduler_share": round((cpu_seconds(scheduler) - used) / wall, 3),
        "handed_out_late_ms": round(1000 * late, 1),
    }


def table(rows: list[dict[str, float]]) -> str:
    """Return the figures as Markdown."""
    lines = [
        "| tasks handed out a second | done a second | latency p50 | p95 | CPU of the scheduler |",
        "| --- | --- | --- | --- | --- |",
    ]
    for row in rows:
        lines.append(
            f"| {row['rate']} | {row['done_per_s']} | {row['latency_p50_ms']} ms "
            f"| {row['latency_p95_ms']} ms | {100 * row['scheduler_share']:.0f} % of a core |"
        )
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measure, print the table, and write the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=20.0, help="for each rate")
    parser.add_argument("-o", "--output", type=Path, help="JSON; the table goes beside it")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        file = f"{folder}/scheduler.json"
        scheduler = start("scheduler", "--port", "0", "--scheduler-file", file)
        options = ("--nthreads", "1", "--no-nanny", "--local-directory", folder)
        workers = [start("worker", "--scheduler-file", file, *options) for _ in range(given.workers)]
        try:
            connect: Any = Client  # without types
            with connect(scheduler_file=file, set_as_default=False, timeout=60) as client:
                client.wait_for_workers(given.workers, timeout=120)
                measure(client, scheduler, RATES[0], 1.0)  # what is imported late is imported now
                rows = [measure(client, scheduler, rate, given.seconds) for rate in RATES]
        finally:
            for process in [*workers, scheduler]:
                process.kill()
                process.wait()
    print(table(rows), end="")
    if given.output:
        found = {
            "machine": describe("distributed"),
            "workers": given.workers,
            "seconds": given.seconds,
            "rows": rows,
        }
        given.output.parent.mkdir(parents=True, exist_ok=True)
        given.output.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        given.output.with_suffix(".md").write_text(table(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
