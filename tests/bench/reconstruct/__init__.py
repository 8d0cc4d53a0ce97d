"""Video with known truth through the whole box: how far the joints are from where they were. `make bench-reconstruct`."""
