"""Loading: from stored or freshly rendered samples to batches, in a resumable order."""

__all__ = []
