"""What is printed on shirts and bibs."""

from typing import Final

import cv2
import numpy as np

from edge.simulation.people.clothing import Shirt
from edge.simulation.people.paint import GUTTER_PX, PRINT, Picture
from models.arrays import Float

_DARK: Final = (0.13, 0.13, 0.16)
_WHITE: Final = (1.0, 1.0, 1.0)


def paint_print(picture: Picture, shirt: Shirt | None, number: int) -> None:
    """Print on chest (left half of the patch) and back (right half). A picture only darkens: prints are dark, or tinted.

    Args:
        picture: to be painted on.
        shirt: whose print; None for a bib, which has a number on both sides.
        number: what a number says.
    """
    light = np.ones((PRINT.height, PRINT.width, 3))
    kind = "bib" if shirt is None else shirt.print
    halves = (PRINT.width // 4, PRINT.width * 3 // 4)
    if kind == "band":
        light[88:126] *= 0.45
    elif kind == "stripes":
        for top in range(40, PRINT.height - 20, 36):
            light[top : top + 15] *= (0.55, 0.58, 0.66)
    elif kind == "badge":
        cv2.circle(light, (halves[0] + 42, 74), 11, (0.35, 0.4, 0.5), -1, cv2.LINE_AA)
        cv2.circle(light, (halves[0] + 42, 74), 6, _WHITE, -1, cv2.LINE_AA)
    elif kind == "number":
        _write(light, str(number), (halves[0], 112), 1.6)
        _write(light, str(number), (halves[1], 112), 3.0)
    elif kind == "bib":
        _write(light, str(number), (halves[0], 118), 2.6)
        _write(light, str(number), (halves[1], 118), 3.0)
    light[:, :GUTTER_PX], light[:, -GUTTER_PX:] = light[:, GUTTER_PX : GUTTER_PX + 1], light[:, -GUTTER_PX - 1 : -GUTTER_PX]
    picture.tint(PRINT, light)


def _write(light: Float, text: str, centre: tuple[int, int], size: float) -> None:
    thickness = round(4 * size)
    (width, height), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, size, thickness)
    ink = np.zeros(light.shape[:2], np.uint8)
    corner = (centre[0] - width // 2, centre[1] + height // 2)
    cv2.putText(ink, text, corner, cv2.FONT_HERSHEY_SIMPLEX, size, 255, thickness, cv2.LINE_AA)
    light *= 1 - (ink[..., None] / 255) * (1 - np.array(_DARK))
