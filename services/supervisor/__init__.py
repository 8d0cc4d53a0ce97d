"""Starts, watches and restarts the processes of the box."""
