"""Checkpoints made to do harm, by the grammar of it: archive, pickle, tensors, settings, callbacks."""

import io
import pickle
import struct
import zipfile
from collections.abc import Callable
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any

import torch
from lightning.pytorch import Trainer

from normalgan.models import UNetDiscriminator, UNetGenerator

Tree = dict[str, Any]
SETTINGS: Tree = {"size": 32, "width": 4}
EVIL = "harm_on_import"
"""A module that leaves a file where it is imported or anything of it is called."""
SYMPY = {
    "class_path": "sympy.Lambda",
    "init_args": {"signature": "x", "expr": "__import__('pathlib').Path('touched').touch()"},
}
"""What jsonargparse builds from this runs the text."""


def sound() -> Tree:
    """Return what `normalgan fit` saves, of networks that are as small as they get."""
    return deepcopy(_sound())


@cache
def _sound() -> Tree:
    torch.manual_seed(0)
    networks = {"generator": UNetGenerator(**SETTINGS), "discriminator": UNetDiscriminator(**SETTINGS)}
    state = {f"{kind}.{k}": v for kind, network in networks.items() for k, v in network.state_dict().items()}
    states = [torch.optim.RMSprop(network.parameters()).state_dict() for network in networks.values()]
    loops = Trainer(logger=False, barebones=True).fit_loop.state_dict()
    optimizer = {"class_path": "torch.optim.RMSprop", "init_args": {"lr": 0.005, "alpha": 0.99}}
    return {
        "epoch": 3,
        "global_step": 12,
        "pytorch-lightning_version": "2.6.0",
        "state_dict": state,
        "callbacks": {"LastCheckpoint{}": {"best_model_path": "/run/checkpoints/last.ckpt"}},
        "loops": {"fit_loop": loops},
        "optimizer_states": states,
        "lr_schedulers": [{"last_epoch": 3}, {"last_epoch": 3}],
        "hparams_name": "kwargs",
        "hyper_parameters": {
            "generator": {"class_path": "normalgan.models.UNetGenerator", "init_args": dict(SETTINGS)},
            "discriminator": {
                "class_path": "normalgan.models.UNetDiscriminator",
                "init_args": dict(SETTINGS),
            },
            "hint_sampler": {"class_path": "normalgan.hints.UniformHints", "init_args": {"minimum": 3}},
            "objective": {"class_path": "normalgan.losses.Wasserstein", "init_args": {"weight_clip": 0.01}},
            "generator_optimizer": optimizer,
            "discriminator_optimizer": "normalgan.gan._rmsprop",
            "lr_scheduler": {
                "class_path": "torch.optim.lr_scheduler.CosineAnnealingLR",
                "init_args": {"T_max": 30},
            },
            "reconstruction": {
                "class_path": "normalgan.losses.L1AndHints",
                "init_args": {"l1_weight": 50000.0},
            },
            "adversarial_weight": 1.0,
            "gradient_clip": None,
            "n_critic": 5,
            "noise_at_test": False,
            "seed": 0,
            "_instantiator": "lightning.pytorch.cli.instantiate_module",
        },
    }


def put(*keys: str, value: Any) -> Callable[[Tree], object]:
    """Return an edit that puts a value somewhere in a checkpoint."""

    def edit(tree: Tree) -> None:
        place = tree
        for key in keys[:-1]:
            place = place[key]
        place[keys[-1]] = value

    return edit


def part(name: str, **value: Any) -> Callable[[Tree], object]:
    """Return an edit of a setting of the model that names a class."""
    return put("hyper_parameters", name, value=value)


def _itself() -> list[Any]:
    endless: list[Any] = []
    endless.append(endless)
    return endless


def _laughs() -> list[Any]:
    many: list[Any] = ["x"]
    for _ in range(40):
        many = [many] * 10
    return many


def _widen(tree: Tree) -> None:
    """Claim a wide network whose tensors repeat one number."""
    with torch.device("meta"):
        wide = UNetGenerator(size=32, width=400).state_dict()
    for name, tensor in wide.items():
        tree["state_dict"][f"generator.{name}"] = torch.zeros((), dtype=tensor.dtype).expand(tensor.shape)
    tree["hyper_parameters"]["generator"]["init_args"]["width"] = 400


LAMBDA = "torch.optim.lr_scheduler.LambdaLR"
NETWORK = "normalgan.models.UNetGenerator"
MODEL: dict[str, tuple[Callable[[Tree], object], str]] = {
    "a class that is imported": (
        part("generator", class_path=f"{EVIL}.Foo"),
        f"no Generator named '{EVIL}.Foo'",
    ),
    "a function": (
        part("generator", class_path="os.system", init_args={"command": "x"}),
        "no Generator named",
    ),
    "a module under ours": (part("generator", class_path=f"{EVIL}.UNetGenerator"), "no Generator named"),
    "another kind of ours": (part("generator", class_path="normalgan.hints.NoHints"), "no Generator named"),
    "a path in a setting": (
        part("generator", class_path=NETWORK, init_args={"norm": f"{EVIL}.run"}),
        "settings that a model brings",
    ),
    "a class in a setting": (
        part("generator", class_path=NETWORK, init_args={"norm": SYMPY}),
        "norm of normalgan.models.UNetGenerator is a dict",
    ),
    "a class in a list": (
        part("generator", class_path=NETWORK, init_args={"norm": [SYMPY]}),
        "settings that a model brings",
    ),
    "further arguments": (
        part("generator", class_path=NETWORK, dict_kwargs=SYMPY),
        "not a class with settings",
    ),
    "settings as text": (
        part("generator", class_path=NETWORK, init_args=str(SYMPY)),
        "not a class with settings",
    ),
    "a text for a class": (part("generator", class_path=SYMPY), "not a class with settings"),
    "a list that holds itself": (
        part("generator", class_path=NETWORK, init_args={"width": _itself()}),
        "width of normalgan.models.UNetGenerator is a list",
    ),
    "lists without end": (
        part("generator", class_path=NETWORK, init_args={"width": _laughs()}),
        "width of normalgan.models.UNetGenerator is a list",
    ),
    "an endless number": (
        part("generator", class_path=NETWORK, init_args={"width": 10**300}),
        "width of normalgan.models.UNetGenerator is 1000000",
    ),
    "not a number": (
        part("generator", class_path=NETWORK, init_args={"dropout": float("nan")}),
        "dropout of normalgan.models.UNetGenerator is nan",
    ),
    "wider than its weights": (
        part("generator", class_path=NETWORK, init_args={"size": 32, "width": 400}),
        "its weights are not those of a UNetGenerator",
    ),
    "a seed that is a class": (part("seed", **SYMPY), "its seed is"),
    "line widths that are a class": (part("line_widths", **SYMPY), "line_widths is"),
}
"""Edits of the model that every command refuses, each with a part of the sentence."""

TRAINING: dict[str, tuple[Callable[[Tree], object], str]] = {
    "the hints' class": (
        part("hint_sampler", class_path=f"{EVIL}.Foo"),
        f"no HintSampler named '{EVIL}.Foo'",
    ),
    "a schedule that runs a text": (
        part("lr_scheduler", class_path=LAMBDA, init_args={"lr_lambda": SYMPY}),
        f"lr_lambda of {LAMBDA}",
    ),
    "a schedule that calls a function": (
        part("lr_scheduler", class_path=LAMBDA, init_args={"lr_lambda": f"{EVIL}.run"}),
        "settings that a model brings",
    ),
    "schedules in a schedule": (
        part(
            "lr_scheduler",
            class_path="torch.optim.lr_scheduler.ChainedScheduler",
            init_args={"schedulers": [SYMPY]},
        ),
        "settings that a model brings",
    ),
    "a schedule that is imported": (
        part("lr_scheduler", class_path=f"{EVIL}.Foo"),
        f"its lr_scheduler is {EVIL}.Foo",
    ),
    "an optimiser as a schedule": (
        part("lr_scheduler", class_path="torch.optim.Adam"),
        "its lr_scheduler is",
    ),
    "an optimiser that is imported": (
        part("generator_optimizer", class_path=f"{EVIL}.Adam"),
        f"its generator_optimizer is {EVIL}.Adam",
    ),
    "a function as an optimiser": (
        put("hyper_parameters", "discriminator_optimizer", value="os.system"),
        "not a class",
    ),
    "the discriminator": (part("discriminator", class_path=f"{EVIL}.Foo"), "no Discriminator named"),
    "a wide discriminator": (
        part(
            "discriminator",
            class_path="normalgan.models.UNetDiscriminator",
            init_args={"size": 32, "width": 400},
        ),
        "its weights are not those of a UNetDiscriminator",
    ),
    "the objective": (
        part("objective", class_path="sympy.Lambda", init_args={}),
        "no AdversarialObjective named",
    ),
    "the loss": (
        part("reconstruction", class_path="normalgan.losses.L1AndHints", init_args={"l1_weight": SYMPY}),
        "settings that a model brings",
    ),
    "another model": (
        put("hyper_parameters", "_class_path", value=f"{EVIL}.Model"),
        "has the setting '_class_path'",
    ),
    "a checkpoint above its folder": (
        put("callbacks", "LastCheckpoint{}", "best_model_path", value="/run/checkpoints/../../x.ckpt"),
        "names '/run/checkpoints/../../x.ckpt' as a checkpoint",
    ),
    "a checkpoint elsewhere": (
        put("callbacks", "x", value={"best_model_path": "", "last_model_path": "s3://bucket/all.ckpt"}),
        "names 's3://bucket/all.ckpt' as a checkpoint",
    ),
    "a checkpoint that is none": (
        put("callbacks", "x", value={"best_model_path": "", "best_k_models": {"/home": 1.0}}),
        "names '/home' as a checkpoint",
    ),
}
"""Edits of what only goes on learning: `fit` refuses them, to all others they are nothing."""

RESUMED: dict[str, tuple[Callable[[Tree], object], str]] = {
    "no states of optimisers": (put("optimizer_states", value=[]), "optimizer_states"),
    "one of two": (lambda tree: tree["optimizer_states"].pop(), "optimizer_states"),
    "a state without groups": (put("optimizer_states", value=[{"state": {}}] * 2), "optimizer_states"),
    "a state of another network": (
        lambda tree: tree["optimizer_states"][0]["state"].update({0: {"square_avg": torch.zeros(3, 999)}}),
        "optimizer_states",
    ),
    "no loops": (put("loops", value={}), "loops"),
    "loops that are a list": (put("loops", value=[1]), "loops"),
    "a loop that counts in words": (
        put("loops", "fit_loop", "epoch_progress", "current", "completed", value="many"),
        "loops",
    ),
    "a loop before its start": (
        put("loops", "fit_loop", "epoch_loop.batch_progress", "total", "ready", value=-1),
        "loops",
    ),
    "a loop without its counts": (put("loops", "fit_loop", "epoch_progress", value={}), "loops"),
    "an epoch before the first": (put("epoch", value=-1), "epoch"),
    "steps in words": (put("global_step", value="12"), "global_step"),
    "no version": (put("pytorch-lightning_version", value="latest"), "pytorch-lightning_version"),
    "a version as a number": (put("pytorch-lightning_version", value=2.6), "pytorch-lightning_version"),
    "a version whose files are migrated": (
        put("pytorch-lightning_version", value="0.9.0"),
        "pytorch-lightning_version",
    ),
    "no schedules": (put("lr_schedulers", value=[]), "lr_schedulers"),
}
"""Edits of what a run resumes with, each with the name that the sentence has."""

IGNORED: dict[str, Callable[[Tree], object]] = {
    "how Lightning builds": put("hyper_parameters", "_instantiator", value=f"{EVIL}.run"),
    "former names of the settings": put("hparams", value={"generator": SYMPY}),
    "their type": put("hparams_type", value=f"{EVIL}.run"),
}
"""Edits of what nobody asks."""


def save(path: Path, edit: Callable[[Tree], object] = lambda tree: None) -> Path:
    """Write a sound checkpoint with an edit."""
    path.write_bytes(bytes_of(edit))
    return path


def bytes_of(edit: Callable[[Tree], object] = lambda tree: None) -> bytes:
    """Return a sound checkpoint with an edit."""
    tree = sound()
    edit(tree)
    return _saved(tree)


def _saved(content: Any, **how: Any) -> bytes:
    buffer = io.BytesIO()
    torch.save(content, buffer, **how)
    return buffer.getvalue()


def repacked(**changes: Any) -> bytes:
    """Return a sound archive of the parts, some of them in place of others, as zipfile packs it."""
    compressed, level = changes.pop("compressed", zipfile.ZIP_STORED), changes.pop("level", None)
    packed = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(bytes_of())) as whole,
        zipfile.ZipFile(packed, "w", compressed, compresslevel=level) as target,
    ):
        for name in whole.namelist():
            target.writestr(name, changes.pop(name.rpartition("/")[2], whole.read(name)))
        for name, content in changes.items():
            target.writestr(f"archive/{name}", content)
    return packed.getvalue()


def _calls(module: str, name: str, number: int) -> bytes:
    """Return a pickle that calls something with a number, by the operations that torch's unpickler knows."""
    return b"\x80\x02c" + f"{module}\n{name}\n".encode() + b"\x8a\x08" + struct.pack("<q", number) + b"\x85R."


def _commented() -> bytes:
    content = bytes_of()
    return content[:-2] + struct.pack("<H", 3) + b"abc"


def _lying() -> bytes:
    """Return an archive whose list says that a part is longer than the file."""
    content = bytearray(bytes_of())
    entry = content.rindex(b"PK\x01\x02")
    content[entry + 20 : entry + 28] = struct.pack("<2L", 2**31, 2**31)
    return bytes(content)


class Touch:
    """What a pickle of it does when it is loaded without care: it makes a file."""

    def __reduce__(self) -> tuple[Any, tuple[str, str]]:
        return open, ("touched", "w")


TOUCH = {"hyper_parameters": {"generator": Touch()}, "state_dict": {}}


FILES: dict[str, tuple[Callable[[], bytes], str]] = {
    "empty": (bytes, "damaged or no checkpoint"),
    "pickle": (lambda: pickle.dumps(Path("x")), "damaged or no checkpoint"),
    "touching pickle": (lambda: pickle.dumps(TOUCH), "damaged or no checkpoint"),
    "touching archive": (lambda: _saved(TOUCH), "damaged or no checkpoint"),
    "touching archive of old": (
        lambda: _saved(TOUCH, _use_new_zipfile_serialization=False),
        "damaged or no checkpoint",
    ),
    "tensor": (lambda: _saved(torch.zeros(3)), "holds no normalgan model"),
    "compressed": (lambda: repacked(compressed=zipfile.ZIP_DEFLATED), "its parts are compressed"),
    "bomb": (
        lambda: repacked(compressed=zipfile.ZIP_DEFLATED, level=1, **{"0": bytes(2**29)}),
        "its parts are compressed",
    ),
    "lying": (_lying, "its parts are longer than the file"),
    "two pickles": (lambda: repacked(**{"DATA.PKL": b"x"}), "two of its parts have the same name"),
    "prefixed": (lambda: b"MZ" * 99 + bytes_of(), "it is not an archive of torch"),
    "commented": (_commented, "it is not an archive of torch"),
    "old format": (
        lambda: _saved(sound(), _use_new_zipfile_serialization=False),
        "it is not an archive of torch",
    ),
    "bytes": (
        lambda: repacked(**{"data.pkl": _calls("__builtin__", "bytearray", 2**40)}),
        "it holds __builtin__.bytear",
    ),
    "storage": (
        lambda: repacked(**{"data.pkl": _calls("torch.storage", "UntypedStorage", 2**40)}),
        "it holds torch.storage.UntypedStorage",
    ),
    "system": (lambda: repacked(**{"data.pkl": _calls("os", "system", 1)}), "it holds os.system"),
    "escape": (lambda: repacked(**{"data.pkl": _calls("os\x1b[2J", "a", 1)}), "it holds os??2J.a"),
    "protocol 4": (
        lambda: repacked(**{"data.pkl": pickle.dumps(Path("x"), protocol=4)}),
        "a pickle that torch does not",
    ),
    "repeated": (lambda: bytes_of(_widen), "its tensors are larger than the file"),
}
"""Files that are refused before anything in them is loaded, each with a part of the sentence."""


def attacked_checkpoints() -> dict[str, tuple[bytes, str]]:
    """Return the contents of those that every command refuses, with a part of the sentence."""
    files = {f"file{i}.ckpt": (make(), words) for i, (make, words) in enumerate(FILES.values())}
    edits = enumerate(MODEL.values())
    return files | {f"model{i}.ckpt": (bytes_of(edit), words) for i, (edit, words) in edits}
