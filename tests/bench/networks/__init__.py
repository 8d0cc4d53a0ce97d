"""How well the pose networks see simulated pupils: `make bench-networks`."""
