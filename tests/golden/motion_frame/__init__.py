"""Motion frames that every language must read alike: `<name>.json`, written by hand, says what `<name>.bin` holds.

`python -m tests.golden.motion_frame` writes the bytes anew, which is right only together with a new version of the layout.
"""
