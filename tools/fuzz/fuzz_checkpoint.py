"""Fuzz target: checkpoints, as commands read them that paint with them and as `fit` does to go on."""

import harness

with harness.instrumented():
    from normalgan.weights.checkpoint import read_checkpoint


def read(data: bytes) -> None:
    """Read one."""
    with harness.refusals():
        found = read_checkpoint(harness.as_file(data, "model.ckpt"))
        found.weights(32)
        found.training_settings()


if __name__ == "__main__":
    harness.run(read)
