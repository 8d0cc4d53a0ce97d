"""What people type for a pupil's code, in `codes.json`: the code that it is, null if it is none, and the code that comes next."""
