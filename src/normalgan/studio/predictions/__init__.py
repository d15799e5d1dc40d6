"""Predictions: serve maps, heights, suggested hints and exported files of a drawing."""

__all__ = []
