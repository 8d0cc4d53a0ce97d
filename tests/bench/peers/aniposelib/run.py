"""Runs inside aniposelib's own environment: reconstructs the clips of some files in every setting, each stage timed.

Usage: python run.py SETTINGS IN.npz OUT.npz [IN.npz OUT.npz ...], settings separated by commas. The last line printed is JSON: for
each clip, seconds of wall and of CPU by stage. Before timing, everything is run once on a part of the first clip, so that no
compilation is counted.
"""

import json
import sys
import time
import warnings

import numpy as np
from aniposelib.cameras import Camera, CameraGroup

warnings.filterwarnings("ignore")  # its numba falls back to object mode, and says so at length

LIMBS = [[5, 7], [6, 8], [7, 9], [8, 10], [11, 13], [12, 14], [13, 15], [14, 16]]
TRUNK = [[5, 6], [11, 12], [5, 11], [6, 12]]
LIBRARY = {"scale_smooth": 4, "scale_length": 2, "scale_length_weak": 0.5, "reproj_error_threshold": 15, "n_deriv_smooth": 1}
ANIPOSE = {"scale_smooth": 2, "scale_length": 2, "scale_length_weak": 1, "reproj_error_threshold": 5, "n_deriv_smooth": 3}
OPTIMISED = (("optim_library", "plain", LIBRARY), ("optim_anipose", "plain", ANIPOSE), ("optim_ransac", "ransac", ANIPOSE))
MIN_CAMS = 3
WARM_UP_FRAMES = 16


def group_of(clip):
    """The cameras of a clip."""
    cameras = zip(clip["names"], clip["matrices"], clip["sizes"], clip["rvecs"], clip["tvecs"], strict=True)
    return CameraGroup(
        [Camera(matrix=m, dist=np.zeros(5), size=tuple(s), rvec=r, tvec=t, name=str(n)) for n, m, s, r, t in cameras]
    )


def reconstruct(group, points, settings):
    """Some settings of one clip: points (cameras, frames, joints, 2), NaN where not to be used."""
    cameras, frames, joints, _ = points.shape
    flat = points.reshape(cameras, frames * joints, 2)
    seconds, found = {}, {}

    def timed(stage, work):
        wall, cpu = time.perf_counter(), time.process_time()
        result = work()
        seconds[stage] = {"wall": time.perf_counter() - wall, "cpu": time.process_time() - cpu}
        return result

    def optimised(start, weights):
        return group.optim_points(points.copy(), start.copy(), constraints=LIMBS, constraints_weak=TRUNK, **weights)

    found["plain"] = timed("plain", lambda: group.triangulate(flat.copy())).reshape(frames, joints, 3)
    if {"ransac", "optim_ransac"} & settings:
        picked = timed("ransac", lambda: group.triangulate_ransac(flat.copy(), min_cams=MIN_CAMS))
        found["ransac"] = picked[0].reshape(frames, joints, 3)
    for setting, start, weights in OPTIMISED:
        if setting in settings:
            found[setting] = timed(setting, lambda start=start, weights=weights: optimised(found[start], weights))
    return found, seconds


def main():
    """Reconstruct every clip named on the command line."""
    settings = set(sys.argv[1].split(","))
    files = list(zip(sys.argv[2::2], sys.argv[3::2], strict=True))
    times = []
    for number, (source, target) in enumerate(files):
        with np.load(source) as clip:
            group, points = group_of(clip), clip["points"]
        if number == 0:
            reconstruct(group, points[:, :WARM_UP_FRAMES], settings)
        found, seconds = reconstruct(group, points, settings)
        np.savez(target, **found)
        times.append(seconds)
    print(json.dumps(times))


main()
