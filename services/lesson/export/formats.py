"""What files a take becomes in each format."""

from collections.abc import Mapping

from models.arrays import Bool
from services.lesson.export import beside, bvh, c3d, glb, mot, trc
from services.lesson.export.armature import armature
from services.lesson.export.kinds import Format
from services.lesson.export.take import Take

_WRITERS = {Format.TRC: trc.encode, Format.C3D: c3d.encode, Format.BVH: bvh.encode, Format.GLB: glb.encode, Format.MOT: mot.encode}


def files_of(take: Take, kind: Format) -> dict[str, bytes]:
    """Contents by name. Beside a format that has no place for it stands a JSON file with pupil, keyframes and what is held.

    Raises:
        TakeError: too little is known for this format.
    """
    name = f"{take.name}.{kind}"
    files = {name: _WRITERS[kind](take)}
    held = _held(take, kind)
    return files if held is None else files | {name + beside.SUFFIX: beside.encode(take, held)}


def _held(take: Take, kind: Format) -> Mapping[str, Bool] | None:
    """What is held in a format that has no holes, by joint or coordinate; None for formats that say everything themselves."""
    if kind is Format.BVH:
        tree = armature(take)
        return {bone.name: tree.held[:, index] for index, bone in enumerate(tree.bones)}
    if kind is Format.MOT:
        return {name: flags for name, (_, flags) in mot.coordinates(take).items()}
    return {} if kind is Format.TRC else None
