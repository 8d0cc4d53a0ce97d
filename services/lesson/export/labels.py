"""Names of the 17 points in TRC and C3D: those that Pose2Sim's marker sets for OpenSim have, and what the points are."""

from typing import Final

from models.skeleton import coco


def _label(name: str) -> str:
    side, _, part = name.partition("_")
    return f"{side[0].upper()}{part.capitalize()}" if part else name.capitalize()


LABELS: Final = tuple(_label(name) for name in coco.NAMES)
"""Nose, LEye, REye ... LAnkle, RAnkle; in the order of the points. Left and right are the pupil's own."""
DESCRIPTIONS: Final = tuple(f"COCO keypoint {name.replace('_', ' ')}" for name in coco.NAMES)
