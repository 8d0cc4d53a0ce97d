"""Every measure that the benchmarks print, each defined once. Pure: arrays in, numbers out.

Positions are metres in the world's frame, (frames, joints, 3), NaN where nothing is said; figures are in the units of their names.
Frame k of what was found and of the truth are of one instant.
"""
