"""The smoother's packed equations against a dense Gauss-Newton step that is written down plainly."""

import numpy as np

from models.arrays import Float
from models.skeleton import coco
from services.fusion.config import SmoothingConfig
from services.fusion.limbs import LimbLengths
from services.fusion.smoothing import Smoother
from services.fusion.timing import Tracks
from services.fusion.views import Sighting, Views
from tests.synthetic.gym import ring_rig

FRAME_S = 1 / 30
CONFIG = SmoothingConfig(difference_freedom=float("inf"), limb_sigma=float("inf"))


def _lagrange(knots: int, place: float) -> Float:
    """(knots,) weights of cubic interpolation."""
    base = min(max(int(place) - 1, 0), knots - 4)
    nodes, out = np.arange(base, base + 4), np.zeros(knots)
    for node in nodes:
        others = nodes[nodes != node]
        out[node] = np.prod((place - others) / (node - others))
    return out


def _plain_step(x: Float, joint: int, views: Views, sightings: list[Sighting]) -> Float:
    """(knots, 3) after one reweighted Gauss-Newton step of one joint, of positions (knots, 3)."""
    knots = len(x)
    rows = [np.eye(3 * knots)]
    sides = [x.ravel()]
    for order, sigma in ((3, CONFIG.difference_m[joint]), (2, CONFIG.bend_m[joint])):
        rows.append(np.kron(np.diff(np.eye(knots), n=order, axis=0), np.eye(3)) / sigma)
        sides.append(np.zeros(len(rows[-1])))
    for sighting in sightings:
        weights = _lagrange(knots, sighting.t_s / FRAME_S)
        point, projection = weights @ x, views.projections[sighting.camera]
        u, v, w = projection @ np.append(point, 1.0)
        expected = np.array((u, v)) / w
        jacobian = (projection[:2, :3] - np.outer(expected, projection[2, :3])) / w
        residual, sigma_px = sighting.points_px[joint] - expected, sighting.sigma_px[joint]
        scale2 = CONFIG.robust_sigmas**2
        share = scale2 / (residual @ residual / sigma_px**2 + scale2)
        rows.append(np.kron(weights, jacobian) * share / sigma_px)
        sides.append((residual + jacobian @ point) * share / sigma_px)
    matrix, right = np.concatenate(rows), np.concatenate(sides)
    return np.asarray(np.linalg.solve(matrix.T @ matrix, matrix.T @ right), np.float64).reshape(knots, 3)


def test_one_step_is_the_gauss_newton_step_of_the_pictures_and_the_differences() -> None:
    rng, rig = np.random.default_rng(4), ring_rig(4)
    views, tracks = Views.of(rig), Tracks(4, 8)
    smoother, truth = Smoother(0, FRAME_S, CONFIG), rng.normal((0.0, 0.0, 1.0), 0.2, (coco.COUNT, 3))
    sightings = []
    for t_s in np.sort(rng.uniform(0.0, smoother.last * FRAME_S, 24)):
        camera = int(rng.integers(4))
        points = rig.cameras[camera].project_undistorted(truth) + rng.normal(0.0, 3.0, (coco.COUNT, 2))
        sightings.append(Sighting(camera, 1, float(t_s), points, rng.uniform(1.0, 4.0, coco.COUNT), rng.random(coco.COUNT) < 0.9))
        tracks.add(camera, sightings[-1])
    for joint in range(coco.COUNT):
        smoother.restart(joint, 0.0, truth[joint] + rng.normal(0.0, 0.01, 3))
    before = smoother.positions_m.copy()
    read = np.array([10 * FRAME_S])
    smoothed = smoother.step(tracks, views, LimbLengths(CONFIG), read, np.array([0.2]))
    for joint in range(coco.COUNT):
        expected = _plain_step(before[:, :, joint], joint, views, [seen for seen in sightings if seen.usable[joint]])
        assert np.allclose(smoother.positions_m[:, :, joint], expected, atol=1e-7)
        assert np.allclose(smoothed.points_m[0, joint], expected[10], atol=1e-7)
