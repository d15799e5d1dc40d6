"""Gallery rows from batches."""

import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.callbacks.gallery import Row

__all__ = ["batch_row"]


def batch_row(batch: Batch, index: int, hints: Tensor, preds: Tensor, of_pairs: bool = False) -> Row:
    """Return the gallery row of one sample of a batch.

    Args:
        batch: N samples.
        index: which of them.
        hints: (N, 4, H, W), the generator's hints.
        preds: (N, 3, H, W), its predictions.
        of_pairs: whether samples are pairs on disk, which have a name but no view number.
    """

    def array(tensor: Tensor) -> Tensor:
        return tensor[index].detach().to("cpu", torch.float32)

    mesh, _, view = batch.get("name", [""] * len(preds))[index].rpartition("/")
    return Row(
        title=(mesh if of_pairs else f"{mesh}, view {view}") if mesh else view,
        sketch=array(batch["sketch"])[0].numpy(),
        hints=array(hints).numpy(),
        preds=array(preds).numpy(),
        target=array(batch["normal"]).numpy(),
        mask=array(batch["mask"])[0].numpy() > 0.5,
    )
