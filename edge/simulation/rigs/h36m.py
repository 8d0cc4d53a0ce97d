"""The four cameras of Human3.6M's subject 9, re-entered from the calibration that comes with the data.

Source: Ionescu, Papava, Olaru, Sminchisescu, "Human3.6M: Large Scale Datasets and Predictive Methods for 3D Human Sensing in
Natural Environments", IEEE TPAMI 36(7), 2014 (calibration of the cameras, subject S9). A point of the world is seen at
X_cam = R (X - T), metres; coefficients of the lens are k1 k2 k3 (radial) and p1 p2 (tangential). (Files in circulation that hold
R column by column read as its transpose; only as here do the cameras look at the actor.) The world's z is up and its floor is
z = 0, as ours. The figures are rounded to less than a hundredth of a pixel in the picture.
"""

from typing import Any, Final

import numpy as np

from models.camera.pinhole import Camera
from models.camera.rig import Rig

_CAMERAS: Final[dict[str, dict[str, Any]]] = {
    "54138969": {
        "size": (1000, 1002),
        "focal": (1145.0494, 1143.7811),
        "centre": (512.5415, 515.4515),
        "radial": (-0.20709891, 0.24777518, -0.00307515),
        "tangential": (-0.00142447, -0.00097570),
        "rotation": (
            (-0.90334862, 0.42691198, 0.04132109),
            (0.04153061, 0.18295114, -0.98224441),
            (-0.42689165, -0.88559305, -0.18299858),
        ),
        "place": (2.044459, 4.935117, 1.481228),
    },
    "55011271": {
        "size": (1000, 1000),
        "focal": (1149.6757, 1147.5916),
        "centre": (508.8486, 508.0649),
        "radial": (-0.19421363, 0.24040854, 0.00681998),
        "tangential": (-0.00274089, -0.00161903),
        "rotation": (
            (0.93157205, 0.36348288, -0.00732918),
            (0.06810069, -0.19426748, -0.97858185),
            (-0.35712157, 0.91112038, -0.20572759),
        ),
        "place": (1.990960, -5.123811, 1.568805),
    },
    "58860488": {
        "size": (1000, 1000),
        "focal": (1149.1407, 1148.7990),
        "centre": (519.8158, 501.4027),
        "radial": (-0.20833819, 0.25548801, -0.00246050),
        "tangential": (-0.00076000, 0.00148444),
        "rotation": (
            (-0.92693442, -0.37323035, -0.03862235),
            (-0.04725991, 0.21824049, -0.97475001),
            (0.37223525, -0.90170405, -0.21993346),
        ),
        "place": (-1.670992, 5.211986, 1.528388),
    },
    "60457274": {
        "size": (1000, 1002),
        "focal": (1145.5113, 1144.7739),
        "centre": (514.9682, 501.8820),
        "radial": (-0.19838409, 0.21832368, -0.00894781),
        "tangential": (-0.00181336, -0.00058721),
        "rotation": (
            (0.91546071, -0.39734606, 0.06362229),
            (-0.04940628, -0.26789168, -0.96218141),
            (0.39936288, 0.87769594, -0.26487570),
        ),
        "place": (-1.696043, -3.827100, 1.591413),
    },
}


def h36m_s9() -> Rig:
    """The rig; its cameras are named cam01 to cam04 in the order of Human3.6M's own names."""
    return Rig(tuple(_camera(f"cam{place:02d}", own) for place, own in enumerate(sorted(_CAMERAS), 1)))


def _camera(name: str, own: str) -> Camera:
    entry = _CAMERAS[own]
    (fx, fy), (cx, cy) = entry["focal"], entry["centre"]
    k1, k2, k3 = entry["radial"]
    u, _, v = np.linalg.svd(np.array(entry["rotation"], np.float64))
    rotation = u @ v
    width, height = entry["size"]
    return Camera(
        name=name,
        size_px=(width, height),
        matrix_px=np.array(((fx, 0.0, cx), (0.0, fy, cy), (0.0, 0.0, 1.0))),
        distortion=np.array((k1, k2, *entry["tangential"], k3), np.float64),
        rotation=rotation,
        translation_m=-rotation @ np.array(entry["place"], np.float64),
        shift_px=np.zeros(2),
    )
