"""Every trouble that `kinebox doctor` must name, each really staged: the list in docs/doctor.md is this one.

A stage is a context manager: within it the trouble is there, and what the doctor finds is its value.
"""

from tests.integration.doctor_troubles.cameras import CAMERAS
from tests.integration.doctor_troubles.configuration import CONFIGURATION
from tests.integration.doctor_troubles.data_folder import DATA_FOLDER
from tests.integration.doctor_troubles.installation import INSTALLATION
from tests.integration.doctor_troubles.machine import MACHINE
from tests.integration.doctor_troubles.ports import PORTS
from tests.integration.doctor_troubles.processes import PROCESSES
from tests.integration.doctor_troubles.room import ROOM
from tests.integration.doctor_troubles.taught import TAUGHT
from tests.integration.doctor_troubles.trouble import Trouble

TROUBLES: dict[str, Trouble] = CONFIGURATION | TAUGHT | DATA_FOLDER | MACHINE | INSTALLATION | PORTS | PROCESSES | CAMERAS | ROOM
"""By name, in the order of the document."""
