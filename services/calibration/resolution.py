"""A calibration carried to pictures of another size."""

from dataclasses import replace

import numpy as np

from models.camera.pinhole import Camera


def resized(camera: Camera, size_px: tuple[int, int]) -> Camera:
    """The same camera with its whole picture scaled to `size_px` (width, height), each side by its own factor.

    Pixel centres are whole numbers, so a picture begins at -0.5: u' = (u + 0.5) s - 0.5. The distortion acts on normalised
    coordinates and stays.
    """
    scale = np.array(size_px, np.float64) / np.array(camera.size_px, np.float64)
    matrix = camera.matrix_px.copy()
    matrix[:2] *= scale[:, None]
    matrix[:2, 2] += 0.5 * scale - 0.5
    return replace(camera, size_px=size_px, matrix_px=matrix, shift_px=camera.shift_px * scale)
