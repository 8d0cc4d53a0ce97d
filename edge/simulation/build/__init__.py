"""What only the maintainers run: making the files of the simulated gym that are in the repository."""
