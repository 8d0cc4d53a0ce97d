"""Reconstruction, evaluation, the bus, the tablet and what keeps them running."""
