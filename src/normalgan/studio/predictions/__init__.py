"""Predictions: what the model answers to a drawing: maps, heights, suggested hints and exported files."""

__all__ = []
