"""How good a head is by its five points, which paper and page must show alike: 0 grey, 1 green, 2 yellow, 3 red."""
