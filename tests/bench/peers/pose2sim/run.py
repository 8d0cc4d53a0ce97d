"""Runs inside Pose2Sim's own environment: association, triangulation and filtering of project folders, each timed.

Usage: python run.py FILTERS PROJECT_FOLDER..., filters separated by commas. The last line printed is JSON: for each folder, seconds
of wall and of CPU by stage; a filter is a stage of its name. Importing and reading the configuration are not counted.
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
    """Run the stages in the folders named on the command line."""
    filters = sys.argv[1].split(",")
    times = []
    for folder in sys.argv[2:]:
        os.chdir(folder)
        _, configs = Pose2Sim.read_config_files(None)
        config, seconds = configs[0], {}
        stages = [("association", associate_all), ("triangulation", triangulate_all), *((name, filter_all) for name in filters)]
        for name, stage in stages:
            if name in filters:
                config["filtering"]["type"] = name
            wall, cpu = time.perf_counter(), time.process_time()
            stage(config)
            seconds[name] = {"wall": time.perf_counter() - wall, "cpu": time.process_time() - cpu}
        times.append(seconds)
    print(json.dumps(times))


main()
