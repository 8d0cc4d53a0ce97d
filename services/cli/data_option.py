"""The option `--data`, the same for every command."""

from pathlib import Path
from typing import Annotated

import typer

DataFolder = Annotated[
    Path,
    typer.Option(
        "--data", help="The data folder: networks, footage, lessons, the log and the school's own standards.", file_okay=False
    ),
]
