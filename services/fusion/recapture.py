"""Joints that the smoother has lost are caught again.

The smoother's data term is robust: a picture that shows a joint far from where it is thought to be counts for nothing. That keeps
mistakes of the network out. But a foot that is swung faster than the filter foresaw is out of every picture's reach as well, and
stays there for as long as the swing lasts, however well all cameras see it. So the instants that pictures have just reached are
looked at without any memory: where triangulation finds a point to which clearly fewer views object than to the smoother's, the
smoother goes on from there. What it makes of it is still its own matter. Points that may be the other foot's do not take part
(`doubles.untwinned`): two cameras that take the standing foot for both would hold the swung one down.
"""

import numpy as np

from models.arrays import Float
from services.fusion.config import FusionConfig
from services.fusion.doubles import untwinned
from services.fusion.smoothing import Smoother
from services.fusion.timing import Tracks
from services.fusion.triangulation import objections, triangulate
from services.fusion.views import Views


def recapture(
    smoother: Smoother, index: int, tracks: Tracks, views: Views, centre_m: Float, reach_m: float, config: FusionConfig
) -> None:
    """Catch lost joints at one grid instant within the window.

    Args:
        smoother: changed in place.
        index: of the grid instant.
        tracks: of the person.
        views: the cameras.
        centre_m: (3,) the body's centre then.
        reach_m: no joint is further from it.
        config: `smoothing.recapture_views` says by how many views fewer must object.
    """
    least = config.smoothing.recapture_views
    points, sigma, usable = tracks.at(index * config.frame_s, config.timing)
    if config.sighting.doubled > 1.0:
        usable = untwinned(views, points, usable, centre_m)
    against = objections(views, points, sigma, usable, config.triangulation, smoother.at(index))
    usable = usable & (against > least)
    if usable.any():
        found = triangulate(views, points, sigma, usable, config.triangulation)
        fewer = against - objections(views, points, sigma, usable, config.triangulation, found.points_m)
        near = np.linalg.norm(found.points_m - centre_m, axis=1) < reach_m
        # Where nothing was found all is NaN, and nothing is true.
        smoother.move(index, found.points_m, near & (found.count >= 2) & (fewer > least))
