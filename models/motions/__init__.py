"""What a simulated pupil performs: motions of the body over time, with what is true of them by construction.

Performance (which action, how) -> Motion (poses, contacts, attempts, things) -> sequence (a lesson of one pupil). Pure.
Frame: the world's (metres, z up, the floor at z = 0). An action begins at the origin, looking along x.
"""
