"""Lessons: recorded to files that survive a crash, listed, read back."""
