"""Trains the shipped refiner on coarse maps of the shipped model and the truth at 1024 pixels.

train_refiner.py paint SAMPLES OUT [--splits train val test]
train_refiner.py train SETS OUT.onnx [--minutes 30] [--width 32] [--blocks 3]

SAMPLES is the folder in the cache that `normalgan render --config configs/ours.yaml --config
configs/refiner.yaml` wrote. `paint` predicts the map of each of its sketches as `normalgan generate` does,
but only at the model's own size, and stores it with the truth in OUT. `train` fits the network to these pairs
on one core, at all scales from the model's size to four times that, and reports the errors on held-out
meshes. For the shipped refiner, OUT.onnx is tools/networks/refiner.onnx, of which tools/quantize.py makes the
file in the package.
"""

import argparse
import copy
import json
import math
import warnings
from pathlib import Path
from time import monotonic

import cv2
import numpy as np
import torch
import zarr
from torch import Tensor, nn
from torch.export import Dim

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.exporting.onnx_file import finish
from normalgan.inference.network.extension import extend
from normalgan.inference.network.framing import Frame
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.network.upsampling import CELL, RIM, planes
from normalgan.inference.pipeline import coarse_of
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.hint_files import Hints
from normalgan.inference.reading.picture import Picture
from normalgan.weights.shipped import find_model

LICENCE = "MIT; trained on procedural shapes of normalgan and on CC0 meshes (docs/model_card.md)"
CROP = 192
BATCH = 12
RATE = 2e-3


class Refiner(nn.Module):
    """Takes enlarged normals, lines, mask and depth (N, 6, H, W); returns refined normals (N, 3, H, W)."""

    def __init__(self, width: int, blocks: int) -> None:
        super().__init__()
        self.stem = nn.Conv2d(6, width, CELL, CELL)
        self.blocks = nn.ModuleList(
            nn.Sequential(
                nn.Conv2d(width, width, 3, padding=1), nn.ReLU(), nn.Conv2d(width, width, 3, padding=1)
            )
            for _ in range(blocks)
        )
        # Two cells in each direction reach each pixel, so that no grid of cells shows.
        self.head = nn.ConvTranspose2d(width, 3, 2 * CELL, CELL, CELL // 2)
        nn.init.zeros_(self.head.weight)
        assert self.head.bias is not None
        nn.init.zeros_(self.head.bias)

    def forward(self, given: Tensor) -> Tensor:
        """Return the given normals with the predicted correction added."""
        features = torch.relu(self.stem(given))
        for block in self.blocks:
            features = features + block(features)
        mended: Tensor = given[:, :3] + self.head(torch.relu(features))
        return mended


def main(arguments: list[str] | None = None) -> None:
    """Run one of the stages."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    stages = parser.add_subparsers(dest="stage", required=True)
    stage = stages.add_parser("paint")
    stage.add_argument("samples", type=Path)
    stage.add_argument("out", type=Path)
    stage.add_argument("--splits", nargs="+", default=["train", "val", "test"])
    stage = stages.add_parser("train")
    stage.add_argument("sets", type=Path)
    stage.add_argument("out", type=Path)
    stage.add_argument("--minutes", type=float, default=30.0)
    stage.add_argument("--width", type=int, default=32)
    stage.add_argument("--blocks", type=int, default=3)
    given = parser.parse_args(arguments)
    if given.stage == "paint":
        for split in given.splits:
            predict(given.samples, split, given.out)
    else:
        torch.manual_seed(0)
        train(given.sets, given.out, given.minutes, Refiner(given.width, given.blocks))


def predict(samples: Path, split: str, out: Path) -> None:
    """Predict the maps of a split's sketches, and write a training file for each."""
    arrays = dict(zarr.open_group(samples / "samples.zarr", mode="r", path=split).arrays())
    network = OnnxBackend(find_model(), threads=1)
    generator = np.random.default_rng(0)
    (out / split).mkdir(parents=True, exist_ok=True)
    for i in range(arrays["mask"].shape[0]):
        target = out / split / f"{i:05}.npz"
        sketch, truth, object_ = (np.asarray(arrays[name][i]) for name in ("sketch", "normal", "mask"))
        # The generator's random numbers are the same whether a file exists or not.
        hinted, found, number = generator.random() < 0.5, generator.random() < 0.5, generator.random()
        if target.exists() or not sketch.any() or object_.sum() < 2000:
            continue
        rows, columns = np.nonzero(object_)
        chosen = np.random.default_rng(i).integers(len(rows), size=int(60**number))
        points = np.stack([columns[chosen], rows[chosen]], 1).astype(np.float32) + 0.5
        hints = Hints(points, truth[rows[chosen], columns[chosen]].astype(np.float32)) if hinted else None
        picture = Picture(np.repeat(1 - sketch[..., None].astype(np.float32) / 255, 3, -1), None)
        try:
            prepared = prepare(picture, network.size, None, hints, line_widths=network.line_widths)
        except InputError as error:
            print(f"{split} {i}: {error}")
            continue
        mask = object_
        if found and prepared.mask is not None:
            both, either = prepared.mask & object_, prepared.mask | object_
            mask = prepared.mask if both.sum() > 0.93 * either.sum() else object_
        coarse = coarse_of(prepared, network.predict(prepared.model_input, prepared.hints)[0], mask)
        if not coarse.known.any():
            continue
        normals = extend(coarse.normals, coarse.known, coarse.needed)
        frame = prepared.frame
        row = {
            "coarse": normals.astype(np.float16),
            "frame": np.array([frame.left, frame.top, frame.side]),
            "ink": np.rint(255 * np.clip(prepared.ink, 0, 1)).astype(np.uint8),
            "mask": mask,
            "truth": np.rint(127 * truth.astype(np.float32) * object_[..., None]).astype(np.int8),
        }
        partial = target.with_suffix(".part")
        with partial.open("wb") as file:
            np.savez(file, **row)
        partial.rename(target)
        if i % 50 == 0:
            print(split, i, flush=True)


def opened(path: Path, scale: float | None = None) -> tuple[Floats, Floats]:
    """Return the refiner's input (6, h, w) and the truth (3, h, w), zero off the object.

    Args:
        path: a file that `paint` wrote.
        scale: pixels per pixel of the model; None, or more than the picture has, for the picture's own.
    """
    row = np.load(path)
    left, top, side = row["frame"].tolist()
    coarse = row["coarse"].astype(np.float32)
    size = coarse.shape[0]
    ink, mask = row["ink"].astype(np.float32) / 255, row["mask"]
    truth = row["truth"].astype(np.float32) / 127
    factor = 1.0 if scale is None else min(scale * size / side, 1.0)
    normals = Frame(mask.shape, left, top, side, size).restore(coarse)
    if factor < 1:
        shape = (round(mask.shape[1] * factor), round(mask.shape[0] * factor))
        ink = cv2.resize(ink, shape, interpolation=cv2.INTER_AREA)
        mask = cv2.resize(mask.astype(np.float32), shape, interpolation=cv2.INTER_AREA) > 0.5
        truth = cv2.resize(truth, shape, interpolation=cv2.INTER_AREA)
        length = np.linalg.norm(truth, axis=-1, keepdims=True)
        truth = np.where(length > 0.5, truth / np.maximum(length, 1e-6), 0).astype(np.float32)
        normals = Frame(mask.shape, left * factor, top * factor, side * factor, size).restore(coarse)
    h, w = (each // CELL * CELL for each in mask.shape)
    return planes(normals[:h, :w], ink[:h, :w], mask[:h, :w]), np.moveaxis(truth[:h, :w], -1, 0)


def crops(path: Path, generator: np.random.Generator, count: int = 6) -> list[tuple[Floats, Floats]]:
    """Return crops of a sample at a random scale, randomly mirrored and turned by right angles."""
    given, truth = opened(path, math.exp(generator.uniform(math.log(1.3), math.log(4.5))))
    rows, columns = np.nonzero(given[4])
    out = []
    for _ in range(count):
        chosen = generator.integers(len(rows))
        y = int(np.clip(rows[chosen] - generator.integers(CROP), 0, max(given.shape[1] - CROP, 0)))
        x = int(np.clip(columns[chosen] - generator.integers(CROP), 0, max(given.shape[2] - CROP, 0)))
        a, b = given[:, y : y + CROP, x : x + CROP].copy(), truth[:, y : y + CROP, x : x + CROP].copy()
        if a.shape[1:] != (CROP, CROP):
            continue
        if generator.random() < 0.5:
            a, b = a[:, :, ::-1].copy(), b[:, :, ::-1].copy()
            a[0] *= -1
            b[0] *= -1
        if generator.random() < 0.5:
            a, b = a[:, ::-1].copy(), b[:, ::-1].copy()
            a[1] *= -1
            b[1] *= -1
        if generator.random() < 0.5:  # transposed: y is up and rows go down, so both change sign
            a, b = a.transpose(0, 2, 1).copy(), b.transpose(0, 2, 1).copy()
            a[[0, 1]] = -a[[1, 0]]
            b[[0, 1]] = -b[[1, 0]]
        out.append((a, b))
    return out


def errors(normals: Tensor, truth: Tensor) -> Tensor:
    """Return the angles in radians (N, H, W) between vectors of any length and unit vectors (N, 3, H, W)."""
    unit = normals / (normals.norm(dim=1, keepdim=True) + 1e-6)
    across = torch.linalg.cross(unit, truth, dim=1)
    return torch.atan2((across.square().sum(1) + 1e-12).sqrt(), (unit * truth).sum(1))


def train(sets: Path, out: Path, minutes: float, network: Refiner) -> None:
    """Train a refiner for a number of minutes, and write it as ONNX, with its weights and figures."""
    torch.set_num_threads(1)
    generator = np.random.default_rng(0)
    files = sorted((sets / "train").glob("*.npz"))
    network = network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
    average = copy.deepcopy(network)
    optimizer = torch.optim.RAdam(network.parameters(), lr=RATE, betas=(0.9, 0.98))
    start, step = monotonic(), 0
    pool: list[tuple[Floats, Floats]] = []
    recent: list[float] = []
    while (gone := (monotonic() - start) / (60 * minutes)) < 1:
        while len(pool) < 12 * BATCH:
            pool += crops(files[generator.integers(len(files))], generator)
        batch = [pool.pop(generator.integers(len(pool))) for _ in range(BATCH)]
        given = torch.from_numpy(np.stack([each[0] for each in batch])).to(memory_format=torch.channels_last)
        truth = torch.from_numpy(np.stack([each[1] for each in batch]))
        for group in optimizer.param_groups:
            group["lr"] = RATE * min(gone / 0.02, 1) * (1 + math.cos(math.pi * gone)) / 2
        mended = network(given)
        there = (truth.square().sum(1) > 0.5) & (given[:, 4] > 0.5)
        weight = there.float()
        rim = weight * (given[:, 5] < 6 / RIM)
        angle = errors(mended, truth)
        mean = (angle * weight).sum() / weight.sum().clamp(min=1)
        at_rim = (angle * rim).sum() / rim.sum().clamp(min=1)
        facing = (mended[:, 2] / (mended.norm(dim=1) + 1e-6) - truth[:, 2]) * weight
        # Relief: the average n_z of a neighbourhood should be right.
        relief = nn.functional.avg_pool2d(facing[:, None], 64).abs().sum()
        relief = relief / nn.functional.avg_pool2d(weight[:, None], 64).sum().clamp(min=1e-3)
        loss = mean + 0.5 * at_rim + 0.5 * relief
        optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimizer.step()
        step += 1
        with torch.no_grad():
            for kept, new in zip(average.parameters(), network.parameters(), strict=True):
                kept.lerp_(new, max(0.005, 1 / step))
        recent.append(math.degrees(mean.item()))
        if step % 100 == 0:
            print(step, round(monotonic() - start), f"{np.mean(recent[-100:]):.2f}", flush=True)
        if step % 1000 == 0:
            write(average, out)
            print(report(average, sets, 20), flush=True)
    write(average, out)
    figures = {"steps": step, "minutes": minutes, **report(average, sets)}
    out.with_suffix(".json").write_text(json.dumps(figures, indent=1) + "\n")
    print(json.dumps(figures))


def write(network: Refiner, out: Path) -> None:
    """Write a refiner as ONNX for pictures with any number of cells."""
    torch.save(network.state_dict(), out.with_suffix(".pt"))
    partial = out.with_suffix(".part")
    cells = {2: CELL * Dim("rows", min=1), 3: CELL * Dim("columns", min=1)}
    with warnings.catch_warnings(action="ignore"):  # warnings of torch about its own parts
        program = torch.onnx.export(
            network.eval(),
            (torch.zeros(1, 6, 64, 48),),
            input_names=["planes"],
            output_names=["normal"],
            dynamic_shapes=(cells,),
            opset_version=18,
            dynamo=True,
            verbose=False,
        )
    assert program is not None
    partial.write_bytes(finish(program.model_proto, {"licence": LICENCE}))
    partial.rename(out)
    network.train()


def report(network: Refiner, sets: Path, most: int | None = None) -> dict[str, list[float]]:
    """Return the errors on held-out meshes, enlarged and refined: on the object, at its rim, and in n_z."""
    rows: dict[str, list[list[float]]] = {"enlarged": [], "mended": []}
    files = sorted((sets / "val").glob("*.npz"))[:most]
    with torch.no_grad():
        for path in files:
            given, truth = (torch.from_numpy(each)[None] for each in opened(path))
            there = (truth.square().sum(1) > 0.5) & (given[:, 4] > 0.5)
            rim = there & (given[:, 5] < 6 / RIM)
            for name, normals in (("enlarged", given[:, :3]), ("mended", network(given))):
                angle = torch.rad2deg(errors(normals, truth))
                facing = normals[:, 2] / (normals.norm(dim=1) + 1e-6) - truth[:, 2]
                rows[name].append(
                    [float(angle[there].mean()), float(angle[rim].mean()), float(facing[there].mean())]
                )
    return {name: np.mean(row, axis=0).round(3).tolist() for name, row in rows.items()}


if __name__ == "__main__":
    main()
