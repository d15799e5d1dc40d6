"""Weights from strangers: damaged, of other programs, or made to do harm."""

import json
import pickle
import random
import sys
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest
import torch
from safetensors.torch import save
from small_weights import SETTINGS, make_weights

from normalgan.errors import InputError
from normalgan.weights.file import Weights, parse_weights, read_weights
from normalgan.weights.shipped import SHIPPED

GOOD = make_weights()
Edit = Callable[[dict[str, str]], object]


def with_notes(edit: Edit, weights: Weights = GOOD) -> bytes:
    said = weights.notes.metadata()
    edit(said)
    return save(dict(weights.tensors), said)


def with_generator(**changes: Any) -> bytes:
    part = {"class_path": "UNetGenerator", "init_args": SETTINGS} | changes
    return with_notes(lambda said: said.update(generator=json.dumps(part)))


def with_settings(**changes: Any) -> bytes:
    return with_generator(init_args=SETTINGS | changes)


def with_tensors(edit: Callable[[dict[str, torch.Tensor]], object]) -> bytes:
    tensors = {name: tensor.clone() for name, tensor in GOOD.tensors.items()}
    edit(tensors)
    return save(tensors, GOOD.notes.metadata())


def first_of(tensors: dict[str, torch.Tensor]) -> str:
    return next(name for name, tensor in tensors.items() if tensor.is_floating_point())


def spoil(tensors: dict[str, torch.Tensor]) -> None:
    tensors[first_of(tensors)].view(-1)[0] = torch.nan


def reshape(tensors: dict[str, torch.Tensor]) -> None:
    tensors[first_of(tensors)] = tensors[first_of(tensors)].flatten()


def retype(tensors: dict[str, torch.Tensor]) -> None:
    tensors[first_of(tensors)] = tensors[first_of(tensors)].to(torch.int64)


WHOLE = GOOD.to_bytes()
NESTED = b'{"a":' * 100_000
BAD: dict[str, tuple[bytes, str]] = {
    "empty": (b"", "is damaged or no safetensors"),
    "text": (b"no weights at all\n" * 9, "is damaged or no safetensors"),
    "truncated": (WHOLE[:-100], "is damaged or no safetensors"),
    "longer": (WHOLE + b"more", "is damaged or no safetensors"),
    "pickle": (pickle.dumps({"a": Path("x")}), "is damaged or no safetensors"),
    "header of terabytes": ((2**45).to_bytes(8, "little") + WHOLE[8:], "is damaged or no safetensors"),
    "nested": (len(NESTED).to_bytes(8, "little") + NESTED, "is damaged or no safetensors"),
    "no notes": (save(dict(GOOD.tensors)), "holds weights of another program"),
    "other notes": (save(dict(GOOD.tensors), {"format": "pt"}), "holds weights of another program"),
    "one note less": (with_notes(lambda said: said.pop("seed")), "holds weights of another program"),
    "no class": (with_notes(lambda said: said.update(generator="[1]")), "not a class with settings"),
    "deep notes": (with_notes(lambda said: said.update(generator="[" * 9999)), "not a class with settings"),
    "more than a class": (with_generator(dict_kwargs={}), "not a class with settings"),
    "unknown class": (with_generator(class_path="UNetGenerater"), "Did you mean UNetGenerator?"),
    "import": (with_generator(class_path="antigravity.geohash"), "no Generator named 'antigravity.geohash'"),
    "other kind": (with_generator(class_path="UniformHints"), "no Generator named 'UniformHints'"),
    "import in a setting": (
        with_settings(norm="antigravity.geohash"),
        "norm of UNetGenerator is antigravity",
    ),
    "class in a setting": (
        with_settings(norm={"class_path": "subprocess.Popen"}),
        "norm of UNetGenerator is",
    ),
    "not finite": (with_settings(dropout=float("inf")), "dropout of UNetGenerator is inf"),
    "huge number": (with_settings(width=10**300), "width of UNetGenerator is 1000"),
    "wrong type": (with_settings(width="wide"), "does not take its settings"),
    "unknown setting": (with_settings(wings=2), "does not take its settings"),
    "wrong size": (with_notes(lambda said: said.update(size="-1")), "its size is -1"),
    "endless seed": (with_notes(lambda said: said.update(seed="9" * 5000)), "its seed is 999"),
    "wider": (with_settings(width=8), "its weights are not those of a UNetGenerator with these settings"),
    "widest": (with_settings(width=4096), "its weights are not those of a UNetGenerator"),
    "missing tensor": (with_tensors(lambda t: t.pop(first_of(t))), "is missing, not float32"),
    "tensor too many": (
        with_tensors(lambda t: t.update(more=torch.ones(2))),
        "more is float32 2, not missing",
    ),
    "other shape": (with_tensors(reshape), "its weights are not those"),
    "other type": (with_tensors(retype), "is int64"),
    "nan": (with_tensors(spoil), "are not all finite numbers"),
}


@pytest.mark.parametrize("kind", BAD)
def test_bad_weights_are_refused_in_one_sentence(tmp_path: Path, kind: str) -> None:
    content, words = BAD[kind]
    path = tmp_path / "bad.safetensors"
    path.write_bytes(content)
    with pytest.raises(InputError) as refused:
        read_weights(path)
    said = str(refused.value)
    assert words in said
    assert str(path) in said
    assert "\n" not in said
    assert len(said) < 450 + len(str(path))
    assert "antigravity" not in sys.modules


def test_bad_onnx_files_are_refused(tmp_path: Path) -> None:
    away = onnx.numpy_helper.from_array(np.ones(64, np.float32), "generator.a")
    onnx.external_data_helper.set_external_data(away, str(tmp_path / "bad.onnx"))
    away.ClearField("raw_data")
    elsewhere = onnx.helper.make_model(onnx.helper.make_graph([], "g", [], [], [away]))
    other = onnx.helper.make_model(onnx.helper.make_graph([], "g", [], []))
    whole = SHIPPED.read_bytes()
    for content, words in (
        (b"", "holds weights of another program"),
        (b"no weights at all", "is damaged or no ONNX"),
        (whole[:-9000], "is damaged or no ONNX"),
        (elsewhere.SerializeToString(), "is damaged or no ONNX"),
        (other.SerializeToString(), "holds weights of another program"),
        (
            whole.replace(b"generator.stem.weight", b"generator.stem.weighs"),
            "are not those of a ResidualUNet",
        ),
    ):
        (tmp_path / "bad.onnx").write_bytes(content)
        with pytest.raises(InputError, match=words) as refused:
            read_weights(tmp_path / "bad.onnx")
        assert "\n" not in str(refused.value)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "gone.safetensors"):
        with pytest.raises(InputError, match=r"there are no weights .*; name a file"):
            read_weights(path)


def test_settings_that_ask_for_everything_take_next_to_nothing() -> None:
    part = {"class_path": "ResidualUNetGenerator", "init_args": {"patch": 2}}
    wide = {**part["init_args"], "widths": [4096] * 64, "blocks": [4096] * 64}  # type: ignore[dict-item]
    content = with_generator(class_path=part["class_path"], init_args=wide)
    tracemalloc.start()
    begin = time.process_time()
    with pytest.raises(InputError, match="it would have more weights than there are"):
        parse_weights(content)
    assert time.process_time() - begin < 5
    assert tracemalloc.get_traced_memory()[1] < 100 * 2**20
    tracemalloc.stop()


def test_mutants_are_read_or_refused() -> None:
    rng = random.Random(0)
    header = int.from_bytes(WHOLE[:8], "little")
    refused = 0
    for _ in range(150):
        mutant = bytearray(WHOLE)
        for _ in range(rng.randint(1, 4)):
            place = rng.randrange(8 + header) if rng.random() < 0.8 else rng.randrange(len(mutant))
            mutant[place] = rng.randrange(256)
        try:
            parse_weights(bytes(mutant))
        except InputError:
            refused += 1
    assert 75 < refused <= 150
