"""Export a checkpoint for other programs: ONNX, TorchScript, torch.export."""

__all__ = []
