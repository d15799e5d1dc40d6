"""Seeds, the files that fuzzing starts from: sound files, and files that broke or attacked a reader."""

import json
import shutil
import sys
from collections.abc import Iterable
from pathlib import Path

TESTS = Path(__file__).parents[1] / "tests"
CORPUS = TESTS / "trust" / "corpus"
PROJECT = {
    **{"format": "normalgan-studio", "version": 2, "width": 64, "height": 64},
    **{"strokes": [{"points": [[1, 2], [3, 4]]}], "hints": [], "layers": [], "settings": {}},
}
REQUEST = {
    "hints": [{"x": 9, "y": 7, "normal": [0, 0, 1]}],
    "areas": [
        {
            "points": [1, 1, 9, 1, 9, 9],
            "normal": [0, 0, 1],
            "form": {"kind": "flat", "bevel": 0.2, "strength": 1},
        },
        {"points": [1, 1, 9, 9], "normal": [0, 0, 1], "size": 4, "structure": {"kind": "fur", "period": 9}},
        {"points": [2, 5], "normal": [0, 0, 1], "size": 3, "height": -0.5, "widths": [2]},
    ],
    "source": None,
}


def lay_out_seeds(folder: Path, target: str) -> list[Path]:
    """Write the seeds of a target and return them.

    Args:
        folder: the folder to write to.
        target: name of the target, such as ``drawing``.

    Raises:
        KeyError: if there is no such target.
    """
    sys.path[:0] = [str(TESTS / part) for part in ("", "trust", "weights")]
    folder.mkdir(parents=True, exist_ok=True)
    makers = {"drawing": _pictures, "svg": _pictures, "mesh": _meshes} | {
        "layers": _layers,
        "animation": _animations,
    }
    for name, content in makers.get(target, _other)(target):
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    for reader in READERS[target]:
        for path in sorted((CORPUS / reader).glob("*")):
            shutil.copy(path, folder / f"corpus-{reader}-{path.name}")
    return sorted(folder.iterdir())


def _pictures(target: str) -> Iterable[tuple[str, bytes]]:
    """Return sound and hostile pictures, except those that need a child process with a time limit."""
    from sound_files import sound

    from hostile_pictures import SLOW, hostile

    yield from sound()["drawing"].items()
    for name, (content, words) in hostile(Path("secret.png")).items():
        if words != SLOW and name.endswith(".svg") == (target == "svg"):
            yield name, content


def _meshes(_: str) -> Iterable[tuple[str, bytes | str]]:
    from hostile import MESHES
    from sound_files import sound

    yield from sound()["mesh"].items()
    for name, (content, _words) in MESHES.items():
        yield name, content


def _layers(_: str) -> Iterable[tuple[str, bytes]]:
    """Return small layered files, written by the product and by Krita, and truncated ones."""
    import numpy as np

    from normalgan.decoding import DecodedLayer
    from normalgan.inference.composites.layers import LayeredKind, encode_layers

    pixels = np.zeros((12, 10, 4), np.uint8)
    pixels[2:9, 3:7] = 200
    layers = [
        DecodedLayer("paper", (), 255, 0, 0, 0, 0, np.full((16, 24, 4), 255, np.uint8)),
        DecodedLayer("arm", ("limbs", "left"), 128, 5, 3, 1, 0, pixels),
    ]
    kinds: tuple[LayeredKind, ...] = ("psd", "ora", "aseprite")
    for kind in kinds:
        content = encode_layers(kind, (16, 24), layers)
        yield from {f"sound.{kind}": content, f"cut.{kind}": content[: len(content) // 2]}.items()
    moving = [*layers, DecodedLayer("arm", ("limbs", "left"), 64, 6, 3, 1, 1, pixels)]
    yield "moving.aseprite", encode_layers("aseprite", (16, 24), moving, [80, 90])
    for path in sorted((TESTS / "inference" / "composites" / "layered").iterdir()):
        yield path.name, path.read_bytes()


def _animations(_: str) -> Iterable[tuple[str, bytes]]:
    """Return animations of three frames, and truncated ones."""
    import numpy as np

    from normalgan.inference.composites.animation import Kind, encode_animation

    frames = [np.full((16, 24, 4), 255, np.uint8) for _ in range(3)]
    for number, frame in enumerate(frames):
        frame[4:12, 4 + 4 * number, :3] = 0
    kinds: tuple[Kind, ...] = ("gif", "webp", "png")
    for kind in kinds:
        for channels in (3, 4):
            content = encode_animation(kind, [each[..., :channels] for each in frames], [40, 80, 120], 0)
            yield f"moving{channels}.{kind}", content
        yield f"cut.{kind}", content[: 2 * len(content) // 3]


def _other(target: str) -> Iterable[tuple[str, bytes | str]]:
    if target == "checkpoint":
        from attacked_checkpoints import attacked_checkpoints, bytes_of

        yield "sound.ckpt", bytes_of()
        for name, (content, _) in attacked_checkpoints().items():
            yield name, content
    elif target == "weights":
        from small_weights import make_weights

        content = make_weights().to_bytes()
        yield from {"sound": content, "cut": content[:-9], "header": b"\xff" * 8 + content[8:]}.items()
    elif target == "configuration":
        from hostile import CONFIGURATIONS, PLANS
        from sound_files import sound

        for reader, files in (("configuration", CONFIGURATIONS), ("plan", PLANS)):
            yield from sound()[reader].items()
            for name, (words, _) in files.items():
                yield f"{reader}-{name}", words
    elif target == "project":
        yield from {"project.json": json.dumps(PROJECT), "request.json": json.dumps(REQUEST)}.items()
        yield from {"deep.json": "[" * 200_000, "digits.json": '{"width": ' + "1" * 10_000 + "}"}.items()
    elif target == "model":
        from sound_files import sound

        yield from sound()["model"].items()
    else:
        raise KeyError(target)


READERS = {
    "drawing": ("drawing",),
    "svg": ("drawing",),
    "mesh": ("mesh",),
    "checkpoint": (),
    "weights": (),
    "configuration": ("configuration", "plan"),
    "project": (),
    "model": ("model",),
    "layers": (),
    "animation": (),
}
"""The targets, and the names of their kinds of files in tests/trust/corpus."""
