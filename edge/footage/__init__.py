"""The built-in footage: what a box without cameras plays, and what the benches measure on."""
