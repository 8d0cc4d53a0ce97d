"""The error that a person at the command line is shown.

`UserError` carries one line that names the camera, file or key at fault and says what to do. The command line prints the
line and leaves with exit code `USER_ERROR_CODE`; anything else that is raised is a defect of ours and keeps its traceback.
"""

USER_ERROR_CODE = 2
"""Exit code of a process that said in one line what a person must do; until that is done, starting it again cannot help."""
USER_ERROR_PREFIX = "kinebox: "
"""How that line begins, by which the supervisor knows it among all others."""


class UserError(Exception):
    """What happened, where, and what to do about it, in one line."""
