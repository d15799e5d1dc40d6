import math

import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation
from torch import Tensor

from normalgan.errors import InputError
from normalgan.metrics import angular_error, l1_distance, l2_distance, unit_vectors, without_hints


def vector(*xyz: float) -> Tensor:
    return torch.tensor(xyz, dtype=torch.float32).view(1, 3, 1, 1)


def random_maps(seed: int = 0) -> tuple[Tensor, Tensor]:
    rng = torch.Generator().manual_seed(seed)
    return torch.randn(2, 3, 20, 30, generator=rng), torch.randn(2, 3, 20, 30, generator=rng)


@pytest.mark.parametrize("degrees", [0.0, 1e-4, 0.01, 1.0, 45.0, 90.0, 135.0, 179.99, 180.0])
def test_known_angles_in_single_precision(degrees: float) -> None:
    axis = np.array([1.0, 2.0, -2.0]) / 3
    target = np.cross(axis, [0.0, 0.0, 1.0])
    target /= np.linalg.norm(target)
    preds = Rotation.from_rotvec(math.radians(degrees) * axis).apply(target)
    error = angular_error(vector(*preds), vector(*target))
    assert error.dtype == torch.float32
    assert error.item() == pytest.approx(degrees, abs=1.5e-5)


def test_angle_is_arccos_of_the_cosine_in_double() -> None:
    preds, target = random_maps()
    p, t = preds.double().numpy(), target.double().numpy()
    cosine = (p * t).sum(1) / np.linalg.norm(p, axis=1) / np.linalg.norm(t, axis=1)
    error = angular_error(preds, target)
    assert error.shape == (2, 1, 20, 30)
    np.testing.assert_allclose(error[:, 0].numpy(), np.degrees(np.arccos(cosine)), atol=2e-5)


def test_angle_depends_on_no_length_and_no_common_rotation() -> None:
    preds, target = random_maps()
    turn = torch.tensor(Rotation.from_rotvec([0.3, -1.2, 2.0]).as_matrix(), dtype=torch.float32)
    turned = [torch.einsum("ij,njhw->nihw", turn, vectors) for vectors in (preds, target)]
    expected = angular_error(preds, target)
    assert torch.allclose(angular_error(*turned), expected, atol=1e-4)
    for scale in (1e-30, 1e30):
        assert torch.allclose(angular_error(preds * scale, target), expected, atol=1e-4)


def test_zero_vector_is_at_a_right_angle_to_all() -> None:
    zero, up = vector(0, 0, 0), vector(0, 1, 0)
    assert [angular_error(*pair).item() for pair in ((zero, up), (up, zero), (zero, zero))] == [90.0] * 3


def test_not_a_number_stays_so() -> None:
    assert angular_error(vector(math.nan, 0, 0), vector(1, 0, 0)).isnan().all()


@pytest.mark.parametrize("order", [1, 2])
def test_distances_are_numpys_norms(order: int) -> None:
    preds, target = random_maps()
    distance = l1_distance(preds, target) if order == 1 else l2_distance(preds, target)
    expected = np.linalg.norm((preds - target).double().numpy(), ord=order, axis=1)
    np.testing.assert_allclose(distance[:, 0].numpy(), expected, rtol=1e-6)


@pytest.mark.parametrize("dtype", [torch.int64, torch.bfloat16, torch.float16, torch.float32, torch.float64])
def test_types(dtype: torch.dtype) -> None:
    right, up = vector(1, 0, 0).to(dtype), vector(0, 1, 0).to(dtype)
    result = torch.float64 if dtype == torch.float64 else torch.float32
    for function, expected in ((angular_error, 90.0), (l1_distance, 2.0), (l2_distance, 2**0.5)):
        assert function(right, up).dtype == result
        assert function(right, up).item() == pytest.approx(expected)


def test_unit_vectors_have_length_one_in_the_same_direction() -> None:
    vectors, _ = random_maps()
    for scale in (1.0, 1e-30, 1e30):
        unit = unit_vectors(vectors * scale)
        assert torch.allclose(torch.linalg.vector_norm(unit, dim=1), torch.ones(2, 20, 30))
        assert torch.allclose(unit, torch.nn.functional.normalize(vectors, dim=1), atol=1e-6)
    assert unit_vectors(vector(0, 0, 0)).eq(0).all()


@pytest.mark.parametrize("function", [angular_error, l1_distance, l2_distance])
@pytest.mark.parametrize("shape", [(1, 3, 4), (1, 4, 4, 4), (2, 3, 4, 4)])
def test_wrong_shapes_are_told(function: object, shape: tuple[int, ...]) -> None:
    assert callable(function)
    with pytest.raises(InputError, match=r"both must be the same \(N, 3, H, W\)"):
        function(torch.zeros(shape), torch.zeros(1, 3, 4, 4))


@pytest.mark.parametrize("dtype", [torch.bool, torch.float32])
def test_without_hints_leaves_the_rest_of_the_object(dtype: torch.dtype) -> None:
    mask = torch.tensor([[1, 1], [0, 0]]).view(1, 1, 2, 2).to(dtype)
    where = torch.tensor([[1, 0], [1, 0]]).view(1, 1, 2, 2).to(torch.float32)
    left = without_hints(mask, where)
    assert left.dtype == dtype
    assert left.flatten().tolist() == [0, 1, 0, 0]
    assert mask.sum() == 2
