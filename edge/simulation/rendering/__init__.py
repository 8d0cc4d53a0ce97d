"""Lessons and strips made on this machine."""
