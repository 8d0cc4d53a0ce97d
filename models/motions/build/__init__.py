"""Makes the recorded part of the motions: the cycle of a run, from a recording that PyPI's pybullet ships."""
