"""The error that a person at the command line is shown.

`UserError` carries one line that names the camera, file or key at fault and says what to do. The command line prints the
line and leaves with exit code 2; anything else that is raised is a defect of ours and keeps its traceback.
"""


class UserError(Exception):
    """What happened, where, and what to do about it, in one line."""
