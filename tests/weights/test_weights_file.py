"""Weights as safetensors: what is written comes back, and others can read it."""

import re
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors import safe_open
from safetensors.torch import load_file
from small_weights import make_generator, make_weights

from normalgan.hints import UniformHints
from normalgan.models import UNetGenerator
from normalgan.version import __version__
from normalgan.weights.file import SHIPPED, parse_weights, read_weights
from normalgan.weights.metadata import ModelMetadata
from plugin_packages import install


def test_what_is_written_paints_the_same_to_the_bit(tmp_path: Path) -> None:
    generator, path = make_generator(), tmp_path / "m.safetensors"
    path.write_bytes(make_weights(generator).to_bytes())
    weights = read_weights(path)
    condition = torch.randn(2, 4, 32, 32)
    read = weights.generator()
    assert isinstance(read, UNetGenerator)
    assert not read.training
    with torch.no_grad():
        assert torch.equal(read(condition), generator(condition))
    assert weights.notes == make_weights().notes
    assert weights.notes.build_hint_sampler() == UniformHints(2, 9, 0.25)
    other = UNetGenerator(size=32, width=4).eval()
    weights.load_into(other)
    with torch.no_grad():
        assert torch.equal(other(condition), generator(condition))


def test_half_the_bits_are_half_the_file_and_nearly_the_same_map() -> None:
    generator = make_generator()
    whole = make_weights(generator)
    content = whole.halved().to_bytes()
    assert len(content) < 0.6 * len(whole.to_bytes())
    half = parse_weights(content).generator()
    assert {p.dtype for p in half.parameters()} == {torch.float32}
    condition = torch.randn(2, 4, 32, 32)
    with torch.no_grad():
        error = (half(condition) - generator(condition)).abs()
    assert 0 < error.max() < 0.01


def test_a_weight_beyond_sixteen_bits_stays_finite() -> None:
    weights = make_weights()
    first = next(iter(weights.tensors))
    weights.tensors[first].view(-1)[0] = 1e9
    assert parse_weights(weights.halved().to_bytes()).tensors[first].view(-1)[0] == 65504


def test_the_same_weights_give_the_same_bytes() -> None:
    assert len({make_weights().to_bytes() for _ in range(5)}) == 1


def test_the_library_reads_all_there_is(tmp_path: Path) -> None:
    generator, path = make_generator(), tmp_path / "m.safetensors"
    path.write_bytes(make_weights(generator).to_bytes())
    tensors = load_file(path)
    assert tensors.keys() == generator.state_dict().keys()
    assert all(torch.equal(tensor, generator.state_dict()[name]) for name, tensor in tensors.items())
    with safe_open(path, "pt") as file:
        said = file.metadata()
    assert said["model"] == "UNetGenerator"
    assert (said["size"], said["seed"], said["noise_at_test"]) == ("32", "7", "true")
    assert (said["licence"], said["normalgan_version"]) == ("CC0-1.0", __version__)
    assert (path.stat().st_size - sum(t.nbytes for t in tensors.values())) % 8 == 0  # numbers are aligned


def test_a_plug_in_is_found_by_its_entry_point(site: Path) -> None:
    source = "from normalgan.models import UNetGenerator\nclass Borrowed(UNetGenerator):\n    'A copy.'\n"
    install(site, "lender", {"lent": source}, {"normalgan.generators": {"Borrowed": "lent:Borrowed"}})
    weights = make_weights()
    said = weights.notes.metadata()
    said["generator"] = said["generator"].replace("UNetGenerator", "Borrowed")
    content = type(weights)(ModelMetadata.parse(said), weights.tensors).to_bytes()
    built = parse_weights(content).generator()
    assert type(built).__name__ == "Borrowed"
    assert type(built).__module__ == "lent"


@pytest.mark.parametrize("suffix", [".safetensors", ".onnx"])
def test_the_package_brings_both_files_of_one_model(suffix: str) -> None:
    path = SHIPPED.with_suffix(suffix)
    assert 2**20 < path.stat().st_size <= 16 * 2**20


def test_the_shipped_files_hold_the_same_weights_and_notes() -> None:
    import onnx
    from onnx import numpy_helper

    model = onnx.load(SHIPPED.with_suffix(".onnx"))
    weights = read_weights(SHIPPED)
    assert {p.key: p.value for p in model.metadata_props} == weights.notes.metadata()
    stored = {t.name.removesuffix(".half"): numpy_helper.to_array(t) for t in model.graph.initializer}
    tensors = {name: tensor for name, tensor in weights.tensors.items() if "num_batches" not in name}
    same = [name for name in tensors if ".second_norm." not in name and not re.search(r"\d\.first\.", name)]
    assert len(same) > 100
    for name in same:
        assert (stored[f"generator.{name}"] == tensors[name].numpy()).all()
        assert stored[f"generator.{name}"].dtype == tensors[name].numpy().dtype
    # ONNX has each second norm of a block as part of the convolution before it.
    folded = [name for name in tensors if re.search(r"\d\.first\.weight", name)]
    assert len(folded) == 22
    for name in folded:
        norm = name.replace("first.weight", "second_norm")
        scale = tensors[f"{norm}.weight"] / (tensors[f"{norm}.running_var"] + 1e-5).sqrt()
        expected = tensors[name].float() * scale[:, None, None, None]
        largest = float(expected.abs().max())
        np.testing.assert_allclose(stored[f"generator.{name}"], expected, rtol=2e-3, atol=1e-3 * largest)
