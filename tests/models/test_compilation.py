"""torch.compile: what it trains is saved by the names of the plain network, and loads."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch
from lightning.pytorch import LightningModule

import normalgan
from normalgan.errors import InputError
from normalgan.weights.checkpoint import read_checkpoint
from small import QUIET, data, gan, trainer

pytestmark = [
    pytest.mark.filterwarnings(each)
    for each in (*QUIET, "ignore::DeprecationWarning", "ignore::FutureWarning")
]


def fit(model: LightningModule, meshes: Path, cache: Path, folder: Path) -> Path:
    run = trainer(folder)
    run.fit(model, data(meshes, cache))
    run.save_checkpoint(folder / "m.ckpt")
    return folder / "m.ckpt"


@pytest.mark.slow  # compiles
def test_compile_trains_to_the_same_weights(meshes: Path, cache: Path, tmp_path: Path) -> None:
    plain = fit(gan(), meshes, cache, tmp_path / "plain")
    compiled = fit(gan(compile="eager"), meshes, cache, tmp_path / "compiled")
    a, b = (torch.load(path, weights_only=True) for path in (plain, compiled))
    assert a["state_dict"].keys() == b["state_dict"].keys()
    for name, tensor in a["state_dict"].items():
        assert torch.allclose(tensor, b["state_dict"][name], atol=1e-5), name
    assert "compile" not in b["hyper_parameters"]


@pytest.mark.slow  # compiles
def test_the_generator_is_compiled(meshes: Path, cache: Path, tmp_path: Path) -> None:
    traced: list[int] = []

    def backend(graph: torch.fx.GraphModule, _: list[torch.Tensor]) -> Callable[..., Any]:
        traced.append(len(list(graph.graph.nodes)))
        return graph.forward

    torch._dynamo.reset()
    torch.compiler.set_stance("default")
    torch._dynamo.register_backend(backend, name="counting")
    fit(gan(compile="counting"), meshes, cache, tmp_path / "run")
    assert sum(traced) > 20


@pytest.mark.slow  # compiles
def test_a_generator_that_is_wrapped_leaves_a_checkpoint_that_loads(
    meshes: Path, cache: Path, tmp_path: Path
) -> None:
    model = gan()
    model.generator = torch.compile(model.generator, backend="eager")  # type: ignore[assignment]
    path = fit(model, meshes, cache, tmp_path / "a")
    assert not [name for name in torch.load(path, weights_only=True)["state_dict"] if "_orig_mod" in name]
    assert normalgan.load(path).backend.size == 32
    again = gan()
    again.generator = torch.compile(again.generator, backend="eager")  # type: ignore[assignment]
    trainer(tmp_path / "b", max_epochs=2).fit(again, data(meshes, cache), ckpt_path=path, weights_only=True)
    older = torch.load(path, weights_only=True)  # of a version that kept the names of the wrapped network
    older["state_dict"] = {
        k.replace("generator.", "generator._orig_mod."): v for k, v in older["state_dict"].items()
    }
    torch.save(older, tmp_path / "older.ckpt")
    assert read_checkpoint(tmp_path / "older.ckpt").weights(32).generator()


@pytest.mark.slow  # compiles
def test_a_model_that_is_wrapped_as_a_whole_trains_and_loads(
    meshes: Path, cache: Path, tmp_path: Path
) -> None:
    whole = torch.compile(gan(), backend="eager")
    path = fit(whole, meshes, cache, tmp_path / "whole")  # type: ignore[arg-type]  # Lightning unwraps it
    assert normalgan.load(path).backend.size == 32


def test_an_unknown_backend_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"compile is true, false or a backend .*, not 'inductr'\. Did you mean inductor\?"
    ):
        gan(compile="inductr")
