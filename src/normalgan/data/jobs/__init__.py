"""Jobs: samples rendered side by side, by processes of this machine or of many."""

__all__ = []
