"""Weights as safetensors or ONNX: what is written comes back, and others can read it."""

from pathlib import Path

import pytest
import torch
from safetensors import safe_open
from safetensors.torch import load_file
from small_weights import make_generator, make_weights

from normalgan.exporting.deployed import Deployed
from normalgan.exporting.formats import halve_onnx, write_onnx
from normalgan.hints import UniformHints
from normalgan.models import ResidualUNetGenerator, UNetGenerator
from normalgan.version import __version__
from normalgan.weights.class_spec import ClassSpec
from normalgan.weights.file import parse_weights, read_weights
from normalgan.weights.metadata import ModelMetadata
from normalgan.weights.shipped import SHIPPED
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


@pytest.mark.slow  # imports the exporter
def test_the_weights_of_an_exported_onnx_file_are_those_of_the_network(tmp_path: Path) -> None:
    torch.manual_seed(3)
    generator = ResidualUNetGenerator(widths=(8, 16), blocks=(1, 1), norm="batch", patch=2)
    for _ in range(3):  # batch norm's statistics differ from those it begins with
        generator(torch.randn(2, 4, 16, 16))
    settings = {"widths": [8, 16], "blocks": [1, 1], "norm": "batch", "patch": 2}
    spec = ClassSpec("ResidualUNetGenerator", settings)
    notes = ModelMetadata(spec, ClassSpec("UniformHints", {}), size=16)
    content = write_onnx(Deployed(generator, 16), notes.metadata())
    (path := tmp_path / "m.onnx").write_bytes(content)
    weights, wanted = read_weights(path), generator.state_dict()
    assert weights.notes == notes
    assert weights.tensors.keys() == wanted.keys()
    learnt = [name for name in wanted if not name.endswith("num_batches_tracked")]
    assert all(torch.equal(weights.tensors[name], wanted[name]) for name in learnt)
    path.write_bytes(halve_onnx(content))
    halved, half = weights.halved().tensors, read_weights(path).tensors
    assert all(torch.equal(half[name], halved[name]) for name in learnt)


def test_the_package_brings_the_model_once() -> None:
    large = [path.name for path in SHIPPED.parent.iterdir() if path.stat().st_size > 8 * 2**20]
    assert large == [SHIPPED.name]
    assert read_weights(SHIPPED).notes.generator.name == "ResidualUNetGenerator"
