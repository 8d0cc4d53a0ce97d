"""One process a camera: from a frame to an observation."""
