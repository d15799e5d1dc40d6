"""Loading: from samples, stored or just rendered, to batches in an order that can be resumed."""

__all__ = []
