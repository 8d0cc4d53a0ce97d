"""Runs inside Pose2Sim's own environment: association, triangulation and filtering of one project folder, each timed.

Usage: python run.py PROJECT_FOLDER. The last line printed is JSON: seconds of wall and of CPU by stage. Importing and reading the
configuration are not counted.
"""

import json
import os
import sys
import time

import matplotlib as mpl

mpl.use("Agg")

from Pose2Sim import Pose2Sim
from Pose2Sim.filtering import filter_all
from Pose2Sim.personAssociation import associate_all
from Pose2Sim.triangulation import triangulate_all


def main() -> None:
    """Run the three stages in the folder named on the command line."""
    os.chdir(sys.argv[1])
    _, configs = Pose2Sim.read_config_files(None)
    seconds = {}
    for name, stage in (("association", associate_all), ("triangulation", triangulate_all), ("filtering", filter_all)):
        wall, cpu = time.perf_counter(), time.process_time()
        stage(configs[0])
        seconds[name] = {"wall": time.perf_counter() - wall, "cpu": time.process_time() - cpu}
    print(json.dumps(seconds))


main()
