"""Run as a process of its own: replays a lesson and prints a check sum of every bit of every motion, live and smooth."""

import hashlib
import sys
from pathlib import Path

import msgspec

from models.messages import codec
from services.lesson.lesson_reader import open_lesson
from services.lesson.replay import configuration, replay


def main(file: Path) -> None:
    total, motions = hashlib.sha256(), 0
    with open_lesson(file) as lesson:
        for item in replay(lesson.parts(), lesson.header.rig(), configuration(lesson.header.preset)):
            for motion in item.motions:
                motions += 1
                total.update(codec.encode(msgspec.structs.replace(motion, t_published_ns=0)))
    sys.stdout.write(f"{motions} {total.hexdigest()}\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
