"""Jobs: parallel rendering, in processes of one or many machines."""

__all__ = []
