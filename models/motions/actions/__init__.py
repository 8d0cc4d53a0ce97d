"""The actions that a simulated pupil can perform, one a file.

Each begins and ends in `models.motions.standing.stand`, at the origin and looking along x at first, so that a lesson can be put
together from them.
"""
