"""Write the bytes; see the package's docstring."""

from services.tablet import motion_frame
from tests.golden.motion_frame.vectors import FOLDER, NAMES, load

for name in NAMES:
    (FOLDER / f"{name}.bin").write_bytes(motion_frame.pack(load(name)))
