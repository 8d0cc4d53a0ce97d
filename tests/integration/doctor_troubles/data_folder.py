"""Troubles of what the set-up put into the data folder, and of the folder itself."""

import resource
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from services.doctor.finding import Examined
from tests.integration.doctor_troubles.trouble import Trouble, broken, examined, flip_byte, installation_here
from tests.integration.house import House, build_house


@contextmanager
def footage_without_a_site(folder: Path) -> Iterator[Examined]:
    house = build_house(folder)
    flip_byte(house.videos / "a.avi")
    yield examined(house, site=None)


def _loop(house: House) -> None:
    shutil.rmtree(house.data)
    house.data.symlink_to(house.data)


def _file_for_folder(house: House) -> None:
    shutil.rmtree(house.data)
    house.data.write_text("")


def _lessons_behind_a_file(house: House) -> None:
    house.site.write_text(f'{house.site.read_text()}[lessons]\nfolder = "disk/lessons"\n')
    (house.data / "disk").write_text("")


@contextmanager
def file_size_limit(folder: Path) -> Iterator[Examined]:
    house = build_house(folder)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    installation_here()
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, before[1]))
    try:
        found = examined(house)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    yield found


DATA_FOLDER: dict[str, Trouble] = {
    "a network file has one wrong byte": Trouble(
        broken(lambda house: flip_byte(house.networks / "nanodet.onnx")),
        "network nanodet",
        r"nanodet\.onnx is damaged",
        "run `make networks DATA=",
    ),
    "no network is installed": Trouble(
        broken(lambda house: shutil.rmtree(house.networks)), "networks", "there are no networks in", "run `make networks DATA="
    ),
    "a camera's file is cut off": Trouble(
        broken(lambda house: (house.videos / "b.avi").write_bytes((house.videos / "b.avi").read_bytes()[:-100])),
        "camera 'b'",
        r"b\.avi has \d+ bytes instead of \d+",
        "run `make footage SOURCE=footage DATA=",
    ),
    "a camera's file has one wrong byte": Trouble(
        broken(lambda house: flip_byte(house.videos / "a.avi")),
        "camera 'a'",
        r"a\.avi is damaged",
        "run `make footage SOURCE=footage DATA=",
    ),
    "a camera's file is missing": Trouble(
        broken(lambda house: (house.videos / "b.avi").unlink()), "camera 'b'", r"b\.avi is missing", "correct `path`"
    ),
    "the built-in footage is damaged": Trouble(
        footage_without_a_site, "footage", r"a\.avi is missing or damaged", "run `make footage SOURCE=footage DATA="
    ),
    "the data folder cannot be read": Trouble(broken(_loop), "data folder", "cannot be used: Too many levels", "correct --data"),
    "the data folder is a file": Trouble(broken(_file_for_folder), "data folder", "is no folder", "correct --data"),
    "nothing can be written to the data folder": Trouble(
        file_size_limit, "data folder", "cannot be used: File too large", "mend its disk"
    ),
    "a file lies where lessons go": Trouble(
        broken(lambda house: (house.data / "lessons").write_text("")),
        "lessons",
        r"nothing can be recorded: .*data/lessons is no folder",
        r"lessons\.folder",
    ),
    "a file lies on the way to where the site file has lessons": Trouble(
        broken(_lessons_behind_a_file), "lessons", r"nothing can be recorded: .*data/disk is no folder", r"lessons\.folder"
    ),
    "the folder of lessons is a link that leads nowhere": Trouble(
        broken(lambda house: (house.data / "lessons").symlink_to(house.data / "unplugged")),
        "lessons",
        "nothing can be recorded: .*data/lessons is a link to .*unplugged, which does not exist",
        "mount its disk",
    ),
    "a folder lies where the list of lessons goes": Trouble(
        broken(lambda house: (house.data / "lessons" / "index.sqlite").mkdir(parents=True)),
        "lessons",
        r"the list of lessons cannot be kept: .*lessons/index\.sqlite is no file",
        "another name",
        "warning",
    ),
}
