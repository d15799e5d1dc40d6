"""What `import normalgan` offers: the names and signatures that may not change unnoticed, and it is light."""

import inspect
from pathlib import Path

import numpy as np
import pytest

import normalgan
from interpreter import loaded
from normalgan.errors import InputError
from pens import blob, outline

GREY = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)


def test_the_public_names() -> None:
    assert normalgan.__all__ == [
        *("InputError", "MeshDataModule", "NormalGAN", "NormalMap", "Pairs", "Predictor", "__version__"),
        *("hints", "load", "losses", "metrics", "models"),
    ]
    assert dir(normalgan) == sorted(normalgan.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'lode'"):
        _ = normalgan.lode


def test_the_public_signatures() -> None:
    def names(function: object) -> list[str]:
        return list(inspect.signature(function).parameters)  # type: ignore[arg-type]

    assert names(normalgan.load) == ["path_or_name", "size"]
    assert inspect.signature(normalgan.load).parameters["path_or_name"].default == "shipped"
    assert names(normalgan.Predictor.__call__) == ["self", "image", "hints", "mask", "size", "tile"]
    assert names(normalgan.NormalMap.save) == ["self", "path", "bits", "y", "alpha", "pad"]
    public = {name for name in dir(normalgan.NormalMap) if not name.startswith("_")}
    fields = set(normalgan.NormalMap.__dataclass_fields__)
    assert public | fields == {
        *("normal", "mask", "confidence", "height", "save", "encode", "alpha", "extended", "seen"),
        *("cells", "findings", "partial", "pixels", "stronger", "tile", "warning"),
    }


def test_importing_it_loads_nothing_heavy_and_the_shipped_model_needs_no_torch() -> None:
    assert not loaded("import normalgan") & {"numpy", "torch", "onnxruntime", "lightning", "cv2"}
    seen = loaded("import normalgan; normalgan.load()")
    assert "onnxruntime" in seen
    assert not seen & {"torch", "lightning", "matplotlib"}


def test_from_an_array_to_a_saved_map(tmp_path: Path) -> None:
    preds = normalgan.load()(GREY)
    assert preds.normal.shape == (*GREY.shape, 3)
    assert preds.confidence is not None
    assert preds.confidence.shape == preds.mask.shape == GREY.shape
    np.testing.assert_allclose(np.linalg.norm(preds.normal[preds.mask], axis=-1), 1, atol=1e-5)
    preds.save(tmp_path / "map.png")
    assert (tmp_path / "map.png").read_bytes() == preds._repr_png_()


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("gone.ckpt", r"^there is no model gone\.ckpt; give a file \(\.onnx, \.safetensors, \.ckpt\)"),
        ("shippd", r"^there is no model shippd; .* Did you mean shipped\?$"),
        ("text.onnx", r"text\.onnx is not a model that ONNX Runtime can run"),
    ],
)
def test_what_is_no_model_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, sentence: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "text.onnx").write_text("no model")
    with pytest.raises(InputError, match=sentence):
        normalgan.load(name)


def test_a_size_that_a_model_has_not_is_refused() -> None:
    assert normalgan.load("shipped", size=256).size == 256
    said = "^shipped predicts pictures of 256 pixels, not 64; omit size: drawings of any size"
    with pytest.raises(InputError, match=said):
        normalgan.load("shipped", size=64)


def test_a_map_says_what_it_is_in_a_line() -> None:
    found = normalgan.load()(GREY)
    assert repr(found) == f"<NormalMap of 300 × 200 pixels, {found.mask.mean():.0%} of them the object>"


def test_onnx_runtime_gives_this_computer_no_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ORT_DISABLE_TELEMETRY", raising=False)
    for name in ("HOME", "USERPROFILE", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(tmp_path))
    loaded("import normalgan, onnxruntime")
    assert not [path for path in tmp_path.rglob("*") if "onnxruntime" in path.as_posix()]
