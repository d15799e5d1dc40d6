"""Fuzz target: files in YAML: a configuration, a plan, a cluster file."""

import harness

with harness.instrumented():
    from normalgan.benchmark.plan import read_plan
    from normalgan.cli.config_files import check_config
    from normalgan.data.jobs.cluster_address import read_cluster


def read(data: bytes) -> None:
    """Read the same bytes as each of them."""
    path = harness.as_file(data, "file.yaml")
    with harness.refusals():
        check_config(path, ("trainer", "data", "model"))
    with harness.refusals():
        read_plan(path)
    with harness.refusals():
        read_cluster(path)


if __name__ == "__main__":
    harness.run(read)
