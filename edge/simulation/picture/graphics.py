"""The graphics library, opened without a display: OpenGL over EGL, which Mesa draws on the processor if there is no other."""

import os
from functools import cache
from typing import TYPE_CHECKING

from models.errors import UserError

if TYPE_CHECKING:
    import moderngl

_VERSION = 430
_INSTALL = "apt-get install libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri"


@cache
def graphics() -> "moderngl.Context":
    """This process' context, opened for the thread that asks first. What is no longer used is freed.

    Raises:
        UserError: moderngl, EGL or a driver for OpenGL 4.3 is missing; says what to install.
    """
    # A renderer is one of several processes; threads of the driver would only take the processor from the others.
    os.environ.setdefault("LP_NUM_THREADS", "1")
    try:
        import moderngl  # noqa: PLC0415 - an extra: only who renders needs it
    except ImportError as error:
        raise UserError(f"rendering needs moderngl ({error}); install it with `.venv/bin/pip install 'moderngl>=5.12'`") from error
    try:
        context = moderngl.create_context(standalone=True, backend="egl", require=_VERSION)  # type: ignore[arg-type]  # its stub is wrong
    except Exception as error:  # moderngl raises Exception itself, with what the driver said
        raise UserError(f"OpenGL 4.3 over EGL could not be opened ({error}); install it with `{_INSTALL}`") from error
    context.gc_mode = "auto"
    # Row 0 is drawn at the bottom: what goes round counter-clockwise in the world goes round clockwise here.
    context.front_face = "cw"
    return context
