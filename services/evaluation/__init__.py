"""From the smooth motion of a lesson to attempts, what was good in them, and one thing to correct (equations 17 to 19)."""
