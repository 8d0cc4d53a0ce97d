"""What a school has changed of what is taught, checked before anything is started.

`kinebox run` finds this by the entry point group `kinebox.checks`. Every start waits for it, and tests have checked what KineBox
brings: where nothing was changed there is nothing to read.
"""

from pathlib import Path

from models.camera.rig import Rig
from models.config.site import SCHOOL_FOLDER, EvaluationConfig, Site


def check(site: Site, _rig: Rig, data: Path) -> None:
    """Read all that is taught, if the site file or a folder of the school's own says anything of it.

    Raises:
        UserError: names the file and what is wrong.
    """
    school = data / SCHOOL_FOLDER
    if site.evaluation == EvaluationConfig() and not (school.is_symlink() or school.exists()):
        return
    from services.evaluation.taught import configuration  # noqa: PLC0415 - see above

    configuration(site, data)
