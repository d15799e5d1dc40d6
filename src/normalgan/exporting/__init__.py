"""From a checkpoint to a file that other programs run: ONNX, TorchScript, torch.export."""

__all__ = []
