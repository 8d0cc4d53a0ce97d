"""Data sets that users hold, read as lessons for `make bench-reconstruct DATASET=... PATH=...`. None of them is part of KineBox."""
