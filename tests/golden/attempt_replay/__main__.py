"""Write the bytes; see the package's docstring."""

from services.tablet import attempt_replay
from tests.golden.attempt_replay.vectors import FOLDER, NAMES, load

for name in NAMES:
    (FOLDER / f"{name}.bin").write_bytes(attempt_replay.pack(load(name)))
