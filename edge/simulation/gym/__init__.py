"""The hall and what stands in it."""
