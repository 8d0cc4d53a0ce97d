"""Fusion's hot loops are compiled as everyone's."""

from models.compiled import Counts, compiled

__all__ = ["Counts", "compiled"]
