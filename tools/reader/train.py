"""Trains the reader on pages generated on the fly, and exports it.

train.py VIEWS OUT [--minutes 45] [--start READER.onnx] [--rate 4e-4] [--measure]
train.py VIEWS OUT --export READER.onnx [--start READER.onnx --mix 0.5]

It writes OUT/last.pt every two minutes, and a later run continues from it. The learning rate falls to zero at
the end of the time.
"""

import argparse
import time
from collections.abc import Iterator, Sequence
from itertools import count
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import torch
from crops import SIZES as CROPS
from crops import crop
from network import Reader
from numpy.typing import NDArray
from pages import KINDS, Page, page
from shapes import Views
from torch import Tensor, nn
from torch.nn import functional
from torch.utils.data import DataLoader, IterableDataset

SIZES = (
    ((256, 256), 8), ((256, 192), 10), ((384, 384), 4), ((384, 384), 4), ((384, 288), 5), ((288, 384), 5),
    ((384, 224), 6), ((224, 384), 6),
)  # fmt: skip
CROPPED = 0.4
"""Share of the batches whose pages are cut to their drawing."""
RATE = 1.2e-3
Batch = tuple[Tensor, ...]
"""Pictures, ink, presence, offsets, weights of the presence, weights of the ink."""
RELOAD = 300
"""Number of batches after which newly rendered views are loaded."""


class Pages(IterableDataset[Batch]):
    """An endless stream of batches."""

    def __init__(self, views: Path, seed: int) -> None:
        self.views, self.seed = views, seed

    def __iter__(self) -> Iterator[Batch]:
        cv2.setNumThreads(1)
        views = Views(self.views, held_out=False)
        worker = torch.utils.data.get_worker_info()
        rng = np.random.default_rng([self.seed, worker.id if worker else 0])
        for number in count():
            if number % RELOAD == 0:
                views.reload()
                # Among meshes every thirtieth object has a hole; this makes it at least every eighth.
                pierced = views.pierced * (len(views.shapes) // (8 * max(len(views.pierced), 1)))
                shapes = views.shapes + pierced
                print(len(views.shapes), "views,", len(views.pierced), "with holes", flush=True)
            make, sizes = (crop, CROPS) if rng.random() < CROPPED else (page, SIZES)
            size, pages = sizes[rng.integers(len(sizes))]
            yield batch([make(rng, shapes, size) for _ in range(pages)])


def batch(pages: Sequence[Page]) -> Batch:
    """Return pages as tensors."""

    def stack(parts: list[NDArray[Any]]) -> Tensor:
        return torch.from_numpy(np.ascontiguousarray(np.stack(parts)))

    return (
        stack([p.picture for p in pages]).permute(0, 3, 1, 2),
        stack([p.ink for p in pages]).float(), stack([p.presence for p in pages]).float(),
        stack([p.middle for p in pages]).float(), stack([p.weight for p in pages]).float(),
        stack([p.ink_weight for p in pages]).float(),
    )  # fmt: skip


def loss_of(
    out: Tensor, ink: Tensor, presence: Tensor, middle: Tensor, weight: Tensor, ink_weight: Tensor
) -> Tensor:
    """Return the loss of a batch."""
    out = out.float()
    seen, drawn = out[:, 1], out[:, 0]
    there = functional.binary_cross_entropy_with_logits(seen, presence, reduction="none")
    lines = functional.binary_cross_entropy_with_logits(drawn, ink, reduction="none") * (1 + ink) * ink_weight
    p = seen.sigmoid()
    overlap = 1 - (2 * (p * presence).sum((1, 2)) + 20) / (p.sum((1, 2)) + presence.sum((1, 2)) + 20)
    ways = ((out[:, 2:] - middle).abs().sum(1) * presence).sum() / presence.sum().clamp(min=1)
    return (there * weight).mean() + 0.3 * overlap.mean() + 1.2 * lines.mean() + 0.5 * ways


def measure(model: nn.Module, views: Path, pages_of_kind: int = 24) -> dict[str, float]:
    """Return the mean IoU of the presence on held-out meshes, by kind of difficulty."""
    shapes = Views(views, held_out=True).shapes
    model.eval()
    found = {}
    with torch.no_grad():
        for kind in KINDS:
            rng = np.random.default_rng(5)
            scores: list[float] = []
            inks: list[float] = []
            for _ in range(pages_of_kind // 6):
                pages = [page(rng, shapes, (256, 256), kind) for _ in range(6)]
                pictures, ink, presence, *_ = batch(pages)
                out = model((pictures.float() / 255).contiguous(memory_format=torch.channels_last))
                for prediction, truth, found_scores in (
                    (out[:, 1] > 0, presence > 0.5, scores),
                    (out[:, 0] > 0, ink > 0.5, inks),
                ):
                    both = (prediction & truth).sum((1, 2)).float()
                    found_scores.extend((both / (prediction | truth).sum((1, 2)).clamp(min=1)).tolist())
            found[kind] = float(np.mean(scores))
            found[kind + " ink"] = float(np.mean(inks))
    model.train()
    return found


def export(model: nn.Module, target: Path) -> None:
    """Write the network as ONNX, with inputs of any size."""
    import onnx

    model.eval()
    temporary = target.with_suffix(".tmp.onnx")
    torch.onnx.export(
        model, (torch.zeros(1, 3, 256, 256),), str(temporary), input_names=["picture"], output_names=["read"],
        dynamic_axes={name: {0: "n", 2: "h", 3: "w"} for name in ("picture", "read")},
        opset_version=17, dynamo=False,
    )  # fmt: skip
    loaded = onnx.load(temporary)
    onnx.save(loaded, target)
    temporary.unlink()


def main() -> None:  # noqa: PLR0915 - one run from its first line to its last
    """Train, measure or export."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("views", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--minutes", type=float, default=45)
    parser.add_argument("--start", type=Path, help="an exported reader to start from")
    parser.add_argument("--rate", type=float, default=RATE)
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("--export", type=Path)
    parser.add_argument(
        "--mix", type=float, default=1.0, help="share of the run's weights in the mix with --start"
    )
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    torch.set_num_threads(1)
    torch.manual_seed(0)
    model = Reader()
    mean = torch.optim.swa_utils.AveragedModel(
        model, multi_avg_fn=torch.optim.swa_utils.get_ema_multi_avg_fn(0.995), use_buffers=True
    )
    last = given.out / "last.pt"
    done, seconds = 0, 0.0
    optimizer = torch.optim.AdamW(model.parameters(), given.rate, betas=(0.9, 0.98), weight_decay=0.01)
    if last.exists():
        kept = torch.load(last)
        model.load_state_dict(kept["model"])
        mean.load_state_dict(kept["mean"])
        optimizer.load_state_dict(kept["optimizer"])
        done, seconds = kept["steps"], kept["seconds"]
    elif given.start is not None:
        model.load_onnx(given.start)
        if not (given.measure or given.export):
            shown = (each[0] for each in Pages(given.views, 12345))
            model.settle([next(shown).float() / 255 for _ in range(24)])
        mean.module.load_state_dict(model.state_dict())
    if given.measure or given.export:
        assert isinstance(mean.module, Reader)
        _finish(mean.module, given)
        return
    print(sum(p.numel() for p in model.parameters()), "parameters", flush=True)
    model.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
    loader = DataLoader(Pages(given.views, done), batch_size=None, num_workers=1, prefetch_factor=6)
    start, saved, total = time.monotonic() - seconds, time.monotonic(), 60 * given.minutes
    losses = []
    # A processor without bfloat16 takes ten times as long with it.
    can = torch.cpu.get_capabilities()
    halved = bool(can.get("avx512_bf16") or can.get("amx_bf16"))
    for pictures, *truth in loader:
        spent = time.monotonic() - start
        if spent > total:
            break
        share = spent / total
        for group in optimizer.param_groups:
            group["lr"] = given.rate * min(1.0, done / 100) * min(1.0, (1 - share) / 0.6)
        x = (pictures.float() / 255).contiguous(memory_format=torch.channels_last)
        with torch.autocast("cpu", torch.bfloat16, enabled=halved):
            out = model(x)
        loss = loss_of(out, *truth)
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimizer.step()
        mean.update_parameters(model)
        done += 1
        losses.append(loss.item())
        if done % 50 == 0:
            print(f"{done} steps, {spent:.0f} s, loss {np.mean(losses[-100:]):.4f}", flush=True)
        if time.monotonic() - saved > 120:
            saved = time.monotonic()
            _save(last, model, mean, optimizer, done, spent)
    _save(last, model, mean, optimizer, done, time.monotonic() - start)


def _finish(model: Reader, given: argparse.Namespace) -> None:
    """Mix, measure and export the trained network."""
    if given.mix < 1:
        _mix(model, given.start, given.mix)
    if given.measure:
        for kind, score in measure(model, given.views).items():
            print(f"{kind:16} {score:.3f}")
    if given.export:
        export(model, given.export)


def _mix(model: Reader, start: Path, share: float) -> None:
    """Mix the weights with those of an exported reader, both without normalisations."""
    model.merge()
    other = Reader()
    other.load_onnx(start)
    beside = other.state_dict()
    own = model.state_dict()
    model.load_state_dict(
        {k: torch.lerp(beside[k].float(), v.float(), share).to(v.dtype) for k, v in own.items()}
    )


def _save(
    last: Path, model: nn.Module, mean: nn.Module, optimizer: torch.optim.Optimizer, done: int, seconds: float
) -> None:
    temporary = last.with_suffix(".new")
    torch.save(
        {
            "model": model.state_dict(),
            "mean": mean.state_dict(),
            "optimizer": optimizer.state_dict(),
            "steps": done,
            "seconds": seconds,
        },
        temporary,
    )
    temporary.replace(last)


if __name__ == "__main__":
    main()
