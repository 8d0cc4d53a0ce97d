"""Troubles of the site file and the calibration."""

from tests.integration.doctor_troubles.trouble import Trouble, broken, fault
from tests.integration.house import replace_text

CONFIGURATION: dict[str, Trouble] = {
    "the site file does not exist": Trouble(
        broken(lambda house: house.site.unlink()), "site file", r"site\.toml does not exist", "correct its path"
    ),
    "the site file has an unknown key": Trouble(
        broken(lambda house: replace_text(house.site, "[tablet]\n", "[tablet]\nspeling = 1\n")),
        "site file",
        "speling: there is no such key",
        r"docs/configuration\.md",
    ),
    "the site file asks for faults on demand": Trouble(
        broken(lambda house: house.site.write_text(house.site.read_text() + fault("a", "stall"))),
        "site file",
        "asks for faults on demand: a will fall ill",
        "remove them",
        "warning",
    ),
    "the calibration names another camera": Trouble(
        broken(lambda house: replace_text(house.rig, 'name = "b"', 'name = "z"')),
        "calibration|site file",
        "camera 'b' is not in the calibration",
        "calibrate it or correct its name",
    ),
    "the calibration is cut off": Trouble(
        broken(lambda house: house.rig.write_bytes(house.rig.read_bytes()[:-40])),
        "calibration",
        r"calibration .*rig\.toml",
        "calibrate again",
    ),
    "the page and the bus have one port": Trouble(
        broken(lambda house: replace_text(house.site, f"tcp/127.0.0.1:{house.bus_port}", f"tcp/127.0.0.1:{house.page_port}")),
        "ports",
        "is both the page's and the bus's",
        r"^change tablet\.port or bus\.endpoint in the site file$",
    ),
    "the page's address is none of this machine's": Trouble(
        broken(lambda house: replace_text(house.site, 'host = "127.0.0.1"', 'host = "192.0.2.99"')),
        "ports",
        r"port of the page: .*192\.0\.2\.99",
        r"change tablet\.host",
    ),
    "the page's address can be none": Trouble(
        broken(lambda house: replace_text(house.site, 'host = "127.0.0.1"', 'host = "192.168..5"')),
        "site file",
        r"tablet\.host is no name and no address of a machine",
        "correct it",
    ),
}
