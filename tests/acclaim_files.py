"""A pair of Acclaim files, and a writer of them for tests: the package itself only reads them.

The root is called "root"; every bone may rotate about three axes parallel to the world's. The
children of a joint must all be at the end of its bone.
"""

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.motion import Motion, Skeleton
from numpy_cae.motion.units import CMU_UNIT

HEADER = """:version 1.10
:units
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position {}
  orientation 0 0 0
:bonedata
"""
BONE = """  begin
    name {}
    direction {}
    length 1
    axis 0 0 0 XYZ
    dof rx ry rz
  end
"""


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


ASF = """# a leg and a stump
:version 1.10
:name VICON
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
   begin, end and length 3 mean nothing here
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name hip
     direction 1 0 0
     length 2
     axis 0 0 0  XYZ
  end
  begin
     id 2
     name femur
     direction 0.6 -0.8 0
     length 7.5
     axis 10 20 30  XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
     id 3
     name tibia
     direction 0 -1 0
     length 7
     axis 0 0 20 XYZ
    dof rx
    limits (-10.0 170.0)
  end
  begin
     id 4
     name stump
     direction -1 0 0
     length 2
     axis 0 0 0 XYZ
  end
:hierarchy
  begin
    root hip stump
    hip femur
    femur tibia
  end
"""
AMC = """#!OML:ASF somewhere
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 10 20 30
femur 40 50 60
tibia 70
2
root 1.5 2.5 3.5 -10 -20 -30
femur 1e1 -5.e-1 .5
tibia 6.4e-014
3
root 0 0 0 0 0 0
femur 0 0 0
tibia 0
"""
