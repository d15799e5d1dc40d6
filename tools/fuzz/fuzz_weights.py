"""Fuzz target: weights as safetensors."""

import harness

with harness.instrumented():
    from normalgan.weights.file import parse_weights


def read(data: bytes) -> None:
    """Read them and build the generator that they are of."""
    with harness.refusals():
        parse_weights(data).generator()


if __name__ == "__main__":
    harness.run(read)
