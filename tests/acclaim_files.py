"""A pair of Acclaim files, and a writer of them for tests: the package itself only reads them.

The root is called "root"; every bone may rotate about three axes parallel to the world's. The
children of a joint must all be at the end of its bone.
"""

import re
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.mocap.units import CMU_UNIT
from numpy_cae.motion import Motion, Skeleton

FILES = Path(__file__).with_name("files")
ASF, AMC = ((FILES / name).read_text() for name in ("02.asf", "02_01.amc"))
"""A leg and a stump, and three frames of it."""
HEADER, BONE = re.split(r"(?m)^(?=  begin$)", (FILES / "written.asf").read_text())


def write_asf(skeleton: Skeleton, path: Path) -> None:
    def vector(values: np.ndarray) -> str:
        return " ".join(f"{value / CMU_UNIT:.9g}" for value in values)

    text, hierarchy = HEADER.format(vector(skeleton.offsets[0])), ":hierarchy\n  begin\n"
    for joint, name in enumerate(skeleton.names):
        children = skeleton.children(joint)
        tip = skeleton.end_sites.get(joint, np.zeros(3))
        if children:
            tip = skeleton.offsets[children[0]]
            hierarchy += f"    {name} {' '.join(skeleton.names[child] for child in children)}\n"
        if joint:
            text += BONE.format(name, vector(tip))
    path.write_text(text + hierarchy + "  end\n")


def write_amc(motion: Motion, path: Path) -> None:
    names = motion.skeleton.names
    place = (motion.translations[:, 0] - motion.skeleton.offsets[0]) / CMU_UNIT
    angles = [Rotation.from_quat(q).as_euler("xyz", degrees=True) for q in motion.rotations]
    lines = [":FULLY-SPECIFIED", ":DEGREES", f":SAMPLES-PER-SECOND {motion.rate:.10g}"]
    for frame, (root, bones) in enumerate(zip(place, angles, strict=True)):
        bones = [" ".join(f"{value:.7f}" for value in bone) for bone in bones]
        lines += [str(frame + 1), f"root {' '.join(f'{value:.7f}' for value in root)} {bones[0]}"]
        lines += [f"{name} {bone}" for name, bone in zip(names[1:], bones[1:], strict=True)]
    path.write_text("\n".join(lines) + "\n")


def write_acclaim(motion: Motion, path: Path) -> None:
    """The .amc file at `path` and the .asf file of the same name beside it."""
    write_asf(motion.skeleton, path.with_suffix(".asf"))
    write_amc(motion, path)
