"""The command `kinebox`."""
