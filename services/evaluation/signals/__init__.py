"""Quantities that every frame of a track has: angles, heights, speeds; each with its sigma."""
