r"""Ideas that the speedrun tried and that need code: what did not help lives here and not in the package.

`--set` of benchmarks/speedrun.py names the classes, as the lines of docs/results/speedrun.jsonl do:

    python benchmarks/speedrun.py --idea attention \
        --set "model.generator={class_path: speedrun_ideas.AttentionUNet}"

The optimisers of other packages (schedule-free, SOAP) are in no dependency of the project; the lines that
used them say which version did.
"""

from typing import Any, Literal

import torch
import torch.nn.functional as F
from lightning.pytorch import Callback, LightningModule, Trainer
from torch import Tensor, nn

from normalgan.batch import Batch
from normalgan.data.augmentation import Augmentation, turn_normals
from normalgan.models import ResidualUNetGenerator
from normalgan.optimizers import MuonRAdam
from normalgan.seeds import derive_seed

WIDTHS = (24, 48, 96, 128, 160)
BLOCKS = (1, 1, 2, 2, 2)


class Attention(nn.Module):
    """Adds to features what they are told by all places of the picture; at first nothing.

    Args:
        channels: of the input and the output, a multiple of 32.
    """

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.heads = channels // 32
        self.norm = nn.BatchNorm2d(channels)
        self.into = nn.Conv2d(channels, 3 * channels, 1)
        self.out = nn.Conv2d(channels, channels, 1)
        for parameter in self.out.parameters():
            nn.init.zeros_(parameter)

    def forward(self, features: Tensor) -> Tensor:
        """Return features of the same shape (N, C, H, W)."""
        shape = features.shape
        parts = self.into(self.norm(features)).reshape(len(features), 3, self.heads, 32, -1)
        query, key, value = parts.transpose(-1, -2).unbind(1)  # (N, heads, H · W, 32)
        told = F.scaled_dot_product_attention(query, key, value)
        return features + self.out(told.transpose(-1, -2).reshape(shape))


class AttentionUNet(ResidualUNetGenerator):
    """Our network with self-attention after the blocks of the coarsest levels.

    Args:
        widths: as of `ResidualUNetGenerator`.
        blocks: likewise.
        patch: likewise.
        norm: likewise.
        levels: how many of the coarsest levels have it.
    """

    def __init__(
        self,
        widths: tuple[int, ...] = WIDTHS,
        blocks: tuple[int, ...] = BLOCKS,
        patch: int = 2,
        norm: Literal["batch", "none"] = "batch",
        levels: int = 2,
    ) -> None:
        super().__init__(widths, blocks, patch, norm)
        for level in range(len(widths) - levels, len(widths)):
            self.encoder[level] = nn.Sequential(self.encoder[level], Attention(widths[level]))


class ChannelNorm(nn.LayerNorm):
    """Layer norm over the channels of each pixel."""

    def forward(self, features: Tensor) -> Tensor:
        """Return features of the same shape (N, C, H, W)."""
        return super().forward(features.permute(0, 2, 3, 1)).permute(0, 3, 1, 2)


class ConvNeXtBlock(nn.Module):
    """Liu et al. 2022, "A ConvNet for the 2020s": a depthwise convolution, then two on single pixels.

    Args:
        channels: of the input and the output.
    """

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.layers = nn.Sequential(
            nn.Conv2d(channels, channels, 7, padding=3, groups=channels),
            ChannelNorm(channels),
            nn.Conv2d(channels, 4 * channels, 1),
            nn.GELU(),
            nn.Conv2d(4 * channels, channels, 1),
        )
        self.scale = nn.Parameter(torch.full((channels, 1, 1), 0.1))

    def forward(self, features: Tensor) -> Tensor:
        """Return features of the same shape (N, C, H, W)."""
        return features + self.scale * self.layers(features)


class _Gate(nn.Module):
    def forward(self, features: Tensor) -> Tensor:
        first, second = features.chunk(2, dim=1)
        return first * second


class _ChannelAttention(nn.Module):
    def __init__(self, channels: int) -> None:
        super().__init__()
        self.weigh = nn.Conv2d(channels, channels, 1)

    def forward(self, features: Tensor) -> Tensor:
        weights: Tensor = self.weigh(features.mean((2, 3), keepdim=True))
        return features * weights


class NAFBlock(nn.Module):
    """Chen et al. 2022, "Simple Baselines for Image Restoration": gates in place of activations.

    Args:
        channels: of the input and the output.
    """

    def __init__(self, channels: int) -> None:
        super().__init__()
        double = 2 * channels
        self.first = nn.Sequential(
            ChannelNorm(channels),
            nn.Conv2d(channels, double, 1),
            nn.Conv2d(double, double, 3, padding=1, groups=double),
            _Gate(),
            _ChannelAttention(channels),
            nn.Conv2d(channels, channels, 1),
        )
        self.second = nn.Sequential(
            ChannelNorm(channels), nn.Conv2d(channels, double, 1), _Gate(), nn.Conv2d(channels, channels, 1)
        )
        self.scales = nn.Parameter(torch.full((2, channels, 1, 1), 0.1))

    def forward(self, features: Tensor) -> Tensor:
        """Return features of the same shape (N, C, H, W)."""
        features = features + self.scales[0] * self.first(features)
        return features + self.scales[1] * self.second(features)


class OtherBlocksUNet(ResidualUNetGenerator):
    """Our network with other blocks in place of its residual ones.

    Args:
        kind: of the blocks.
        widths: as of `ResidualUNetGenerator`.
        blocks: likewise.
        patch: likewise.
        norm: of no block here; taken so that the recipe's setting need not be taken away.
    """

    def __init__(
        self,
        kind: Literal["ConvNeXt", "NAF"],
        widths: tuple[int, ...] = WIDTHS,
        blocks: tuple[int, ...] = BLOCKS,
        patch: int = 2,
        norm: Literal["batch", "none"] = "batch",
    ) -> None:
        super().__init__(widths, blocks, patch, norm)
        self.norm = "none"
        block = {"ConvNeXt": ConvNeXtBlock, "NAF": NAFBlock}[kind]
        for levels in (self.encoder, self.decoder):
            for i in range(len(levels)):
                levels[i] = nn.Sequential(*(block(widths[i]) for _ in range(blocks[i])))
        self.to(memory_format=torch.channels_last)  # type: ignore[call-overload]  # missing in torch's types


class AlternatingFlip(Augmentation):
    """Mirrors each sample every other time it is seen, n_x negated, from a first time that is its own.

    So each sample is seen as it is and mirrored equally often (Jordan 2024, "94% on CIFAR-10 in 3.29 Seconds
    on a Single GPU"). It counts by itself, and from the start again when a run is resumed.

    Args:
        rotation: as of `Augmentation`.
        scale: likewise.
        translation: likewise.
    """

    def __init__(
        self, rotation: float = 12.0, scale: tuple[float, float] = (0.85, 1.12), translation: float = 0.05
    ) -> None:
        super().__init__(0.0, rotation, scale, translation, jitter=0.0, dropout=0.0, width=0.0)
        self.seen: dict[str, int] = {}

    def __call__(self, batch: Batch, seed: int) -> Batch:
        """Return an augmented batch; of samples without names, or with hints, it is an error."""
        mirrored = torch.tensor([self._is_mirrored(name) for name in batch["name"]])
        chosen = mirrored.to(batch["sketch"].device)[:, None, None, None]
        mirror = torch.tensor([[-1.0, 0, 0], [0, 1, 0], [0, 0, 1]], device=chosen.device)
        normal = turn_normals(batch["normal"].flip(3), mirror.expand(len(chosen), 3, 3))
        flipped: Batch = {
            **batch,
            "sketch": torch.where(chosen, batch["sketch"].flip(3), batch["sketch"]),
            "normal": torch.where(chosen, normal, batch["normal"]),
            "mask": torch.where(chosen, batch["mask"].flip(3), batch["mask"]),
        }
        return super().__call__(flipped, seed)

    def _is_mirrored(self, name: str) -> bool:
        self.seen[name] = self.seen.get(name, derive_seed("flip", name) % 2) + 1
        return self.seen[name] % 2 == 0


class SmallFirst(Callback):
    """Trains on pictures of half the size first.

    Args:
        epochs: so many, then on whole ones.
        gain: of the ink, which the mean of four pixels pales.
    """

    def __init__(self, epochs: int = 1, gain: float = 1.5) -> None:
        self.epochs = epochs
        self.gain = gain

    def on_train_batch_start(
        self, trainer: Trainer, pl_module: LightningModule, batch: Any, batch_idx: int
    ) -> None:
        """Halve the pictures of a batch, in the batch."""
        if trainer.current_epoch >= self.epochs:
            return
        batch["sketch"] = (self.gain * F.avg_pool2d(batch["sketch"], 2)).clamp(max=1)
        mask = (F.avg_pool2d(batch["mask"].float(), 2) > 0.5).to(batch["mask"].dtype)
        batch["normal"] = F.normalize(F.avg_pool2d(batch["normal"], 2), dim=1) * mask
        batch["mask"] = mask


class ScheduleFreeModes(Callback):
    """Tells an optimiser of the package schedulefree when it is measured and when it trains.

    What is measured are its averaged weights; the statistics of batch norm stay those of training.
    """

    def on_train_epoch_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Train."""
        for optimizer in trainer.optimizers:
            optimizer.train()  # type: ignore[attr-defined]  # of the package

    def on_validation_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Measure."""
        for optimizer in trainer.optimizers:
            optimizer.eval()  # type: ignore[attr-defined]


class EveryOtherMuonRAdam(MuonRAdam):
    """`MuonRAdam` whose wide layers step every other time only, by the mean of two gradients, twice as far.

    To make momentum orthogonal takes as long for a small batch as for a large one. The gradient between two
    steps is in no checkpoint.
    """

    def __init__(
        self,
        params: Any,
        lr: float = 2e-3,
        betas: tuple[float, float] = (0.9, 0.98),
        weight_decay: float = 0.02,
        momentum: float = 0.95,
    ) -> None:
        super().__init__(params, lr, betas, weight_decay, momentum)
        self._held: dict[nn.Parameter, Tensor] = {}

    def _step_wide(self, weights: nn.Parameter, gradient: Tensor, rate: float, decay: float) -> None:
        held = self._held.pop(weights, None)
        if held is None:
            self._held[weights] = gradient.clone()
        else:
            super()._step_wide(weights, (held + gradient) / 2, 2 * rate, decay)


class StepsInFloat32(Callback):
    """Lets optimisers step outside of autocast, which those of pytorch_optimizer do not expect."""

    def on_train_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Wrap the steps."""
        for optimizer in trainer.optimizers:
            whole = torch.autocast(pl_module.device.type, enabled=False)
            optimizer.step = whole(optimizer.step)  # type: ignore[method-assign]
