"""The box's log: the form of its lines, the files that hold them, and reading, filtering and exporting them."""
