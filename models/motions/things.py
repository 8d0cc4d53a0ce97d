"""Sizes and frames of what a pupil plays with.

- Balls: the origin is the centre.
- Racket: the origin is in the middle of the grip, z goes along the shaft to the head, x is square to the strings.
- Shuttlecock: the origin is the tip of the cork, z goes from there to the feathers.

Schools play basketball with size 5 and football with size 4 (rules of FIBA and FIFA for the young); rackets and shuttlecocks are
those of the BWF's laws.
"""

from typing import Final

BASKETBALL_RADIUS_M: Final = 0.112
VOLLEYBALL_RADIUS_M: Final = 0.105
FOOTBALL_RADIUS_M: Final = 0.103
RACKET_LENGTH_M: Final = 0.665
RACKET_GRIP_M: Final = 0.085
"""From the butt to the origin."""
RACKET_SWEET_SPOT_M: Final = 0.47
"""From the origin to the middle of the strings."""
SHUTTLECOCK_LENGTH_M: Final = 0.085
