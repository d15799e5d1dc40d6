"""MuonRAdam: what is orthogonal, what is RAdam's, and what a checkpoint holds."""

import io

import pytest
import torch
from torch import Tensor, nn

from normalgan.optimizers import MuonRAdam, orthogonalized


@pytest.mark.parametrize(("rows", "columns"), [(24, 216), (216, 24), (32, 64)])
def test_all_directions_of_a_matrix_become_equally_long(rows: int, columns: int) -> None:
    torch.manual_seed(0)
    matrix = torch.randn(rows, columns, dtype=torch.float64)
    left, values, right = torch.linalg.svd(matrix, full_matrices=False)
    uneven = left @ torch.diag(values * torch.logspace(0, -2, len(values), dtype=torch.float64)) @ right
    found = orthogonalized(uneven.float())
    assert torch.linalg.svdvals(found).sub(1).abs().max() < 0.2
    nearest = (left @ right).float()
    assert (found - nearest).norm() / nearest.norm() < 0.15


def test_a_matrix_of_zeros_stays_zero() -> None:
    assert torch.equal(orthogonalized(torch.zeros(16, 20)), torch.zeros(16, 20))


def test_mixed_precision_changes_nothing() -> None:
    matrix = torch.randn(24, 40, generator=torch.Generator().manual_seed(0))
    expected = orthogonalized(matrix)
    with torch.autocast("cpu", torch.bfloat16):
        assert torch.equal(orthogonalized(matrix), expected)


def gradients(*parameters: nn.Parameter) -> None:
    for i, parameter in enumerate(parameters):
        parameter.grad = torch.randn(parameter.shape, generator=torch.Generator().manual_seed(i))


def test_what_is_narrow_steps_as_by_radam_and_what_is_wide_by_as_much() -> None:
    torch.manual_seed(0)
    wide, bias, head = (nn.Parameter(torch.randn(shape)) for shape in ((32, 16, 3, 3), (32,), (5, 16, 1, 1)))
    others = [nn.Parameter(each.detach().clone()) for each in (bias, head)]
    ours = MuonRAdam([wide, bias, head], lr=1e-2, betas=(0.9, 0.98), weight_decay=0.1)
    radam = torch.optim.RAdam(
        others, lr=1e-2, betas=(0.9, 0.98), weight_decay=0.1, decoupled_weight_decay=True
    )
    before = wide.detach().clone()
    for _ in range(8):
        gradients(wide, bias, head)
        gradients(nn.Parameter(torch.zeros_like(wide)), *others)
        ours.step()
        radam.step()
        assert torch.equal(bias, others[0])
        assert torch.equal(head, others[1])
        assert wide.grad is not None, "the gradient is still there to be looked at"
    step = (wide.detach() - before * (1 - 1e-3) ** 8).square().mean().sqrt() / 8
    assert 0.5 * 0.2e-2 < step < 1.5 * 0.2e-2, "entries are of Adam's size: a fifth of the rate"


def test_a_convolution_steps_as_the_matrix_that_it_is() -> None:
    kernel = nn.Parameter(torch.zeros(16, 4, 3, 3))
    matrix = nn.Parameter(torch.zeros(16, 36))
    for parameter in (kernel, matrix):
        optimizer = MuonRAdam([parameter])
        parameter.grad = torch.randn(16, 36, generator=torch.Generator().manual_seed(3)).view_as(parameter)
        optimizer.step()
    assert torch.equal(kernel.flatten(1), matrix)


def test_training_goes_on_to_the_bit_from_a_saved_state() -> None:
    def start() -> tuple[nn.Sequential, MuonRAdam]:
        torch.manual_seed(1)
        network = nn.Sequential(nn.Linear(16, 32), nn.Tanh(), nn.Linear(32, 16))
        return network, MuonRAdam(network.parameters(), lr=3e-3)

    def train(network: nn.Sequential, optimizer: MuonRAdam, steps: range) -> Tensor:
        for i in steps:
            data = torch.randn(8, 16, generator=torch.Generator().manual_seed(i))
            loss: Tensor = (network(data) - data.flip(1)).square().mean()
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
        return loss.detach()

    whole = train(*start(), range(40))
    network, optimizer = start()
    first = train(network, optimizer, range(20))
    file = io.BytesIO()
    torch.save((network.state_dict(), optimizer.state_dict()), file)
    file.seek(0)
    weights, state = torch.load(file, weights_only=True)
    network, optimizer = start()
    network.load_state_dict(weights)
    optimizer.load_state_dict(state)
    assert torch.equal(train(network, optimizer, range(20, 40)), whole)
    assert whole < first
