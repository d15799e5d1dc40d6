"""Cleaning: from colours and opacity to ink."""

__all__ = []
