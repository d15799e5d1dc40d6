"""Loading: batches of stored or freshly rendered samples, in a resumable order."""

__all__ = []
