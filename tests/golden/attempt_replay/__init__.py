"""Replays of attempts that every language must read alike: `<name>.json` says what `<name>.bin` holds.

`python -m tests.golden.attempt_replay` writes the bytes anew, which is right only together with a new version of the layout.
"""
