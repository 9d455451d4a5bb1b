"""Read exponential-map text (.txt) of CMU or Human3.6M: one frame a line, separated by commas.

An exponential map is a rotation vector: its length is the angle, its direction the axis. The
authors of this text multiply row vectors with matrices, so their matrices are ours transposed:

    R = exp([v]×)ᵀ = exp(-[v]×)

The first frame of CMU's text confirms it: the T-pose rotates the left thigh by -21° about z in
BVH, and the text has +0.3665.

The literature on motion prediction has two layouts. A line is a frame: three numbers for the
root's translation, then three for each joint of the rig and for each tip of a bone, in the order of
`expmap.json`. The layouts are those of Jain et al. (2016) and MBR17 (Martinez, Black, Romero,
2017); the bone lengths of Human3.6M are those that MBR17 draws with. The CMU text has no bone
lengths: these are subject 02's.
"""

import json
from pathlib import Path

import numpy as np

from numpy_cae.mocap.formats.text_file import MAX_LINE, TextFile
from numpy_cae.mocap.units import CMU_UNIT, require_unit, unit_name
from numpy_cae.motion import Motion, Note, Skeleton, quaternions

_LAYOUTS = json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))
"""For each layout its rows in the order of the text: joint, its parent, offset from the parent,
optional tip. The tip is an offset from the joint; if a row has one, the text holds three zeros for
it after the joint's own numbers."""


class ExpmapRig:
    """One layout: its name, the metres in one unit of its lengths, the frames a second of text in
    this layout, the rig in metres, the indices of its joints among all triples of angles, and the
    numbers in a line."""

    def __init__(self, name: str, unit: float, rate: float):
        self.name = name
        self.unit = unit
        self.rate = rate
        rows = _LAYOUTS[name]
        names = tuple(row[0] for row in rows)
        parents = tuple(-1 if row[1] is None else names.index(row[1]) for row in rows)
        tips = {joint: unit * np.array(row[3]) for joint, row in enumerate(rows) if row[3:]}
        self.skeleton = Skeleton(names, parents, unit * np.array([row[2] for row in rows]), tips)
        *joints, triples = np.cumsum([0, *(len(row) - 2 for row in rows)])
        self.joints = np.array(joints)
        self.width = int(3 + 3 * triples)


CMU = ExpmapRig("CMU", CMU_UNIT, rate=120.0)
HUMAN36M = ExpmapRig("Human3.6M", 0.001, rate=50.0)
EXPMAP_RIGS = (CMU, HUMAN36M)

_MIN_COMMAS = 40
"""A line with more commas is taken for a row of numbers, not for a sentence."""
_CUT = 1.5
"""A larger step (radians) between two frames is a cut, as after the T-pose."""


def read_expmap(path: str | Path, unit: float | None = None) -> Motion:
    r"""Read exponential-map text; the number of values in a line determines the layout.

    Parameters
    ----------
    path : path of the .txt file
    unit : float, optional
        Metres in one unit of length; by default CMU's unit or Human3.6M's millimetre.

    Returns
    -------
    Motion
        On the rig's standard bones, at 120 frames a second (CMU) or 50 (Human3.6M); the text states
        neither bones nor rate.

    Raises
    ------
    MotionFileError
        If the file is damaged.
    ValueError
        If `unit` is not above 0.

    Examples
    --------
    Two frames in CMU's layout, in which nothing is rotated:

    >>> _ = Path("rest.txt").write_text(2 * (",".join(["0"] * CMU.width) + "\n"))
    >>> motion = read_expmap("rest.txt")
    >>> len(motion), motion.rate, motion.skeleton.names[:2]
    (2, 120.0, ('Hips', 'LHipJoint'))
    """
    file = TextFile.read(path)
    rig, values = _table(file)
    metres = rig.unit if unit is None else require_unit(unit)
    # The bones are in metres already; a given unit applies to the translation alone.
    translations = np.tile(rig.skeleton.offsets, (len(values), 1, 1))
    translations[:, 0] = values[:, :3] * metres
    vectors = values[:, 3:].reshape(len(values), -1, 3)[:, rig.joints]
    rotations = quaternions.from_vector(-vectors)
    if rig is CMU:
        rotations[:, 0] = cmu_root(rotations[:, 0])
    source = "of such text" if unit is None else "as given"
    text = f"{unit_name(metres)} ({source}, {rig.name}, the bones are a standard person's)"
    notes = (Note("unit", text), *file.lost_values(values))
    return Motion(rig.skeleton, rig.rate, rotations, translations, metres, notes)


def is_expmap_text(path: str | Path) -> bool:
    """Whether a text file begins with a long row of values that are separated by commas.

    Other .txt files among motions are licences and notes. A row of the wrong length counts too, so
    that `read_expmap` reports the error.
    """
    try:
        with open(path, encoding="latin-1") as file:
            first = file.readline(MAX_LINE).strip() or file.readline(MAX_LINE)
    except OSError:
        return False
    return first.count(",") > _MIN_COMMAS


def _table(file: TextFile) -> tuple[ExpmapRig, np.ndarray]:
    """The layout of a file and its numbers (frames, width)."""
    filled = ((number, text) for number, text in file.numbered_lines() if text.strip())
    line, first = next(filled, (1, ""))
    width = first.count(",") + 1
    rig = next((rig for rig in EXPMAP_RIGS if rig.width == width), None)
    if rig is None:
        widths = " or ".join(f"{rig.width} ({rig.name})" for rig in EXPMAP_RIGS)
        raise file.error(line, f"{width} values, expected {widths}, separated by commas")
    file.require_frames(file.count, len(rig.joints), rig.rate)
    return rig, file.table(0, width, "as in the first line", separator=",")[0]


def cmu_root(text: np.ndarray) -> np.ndarray:
    """Correct the root's rotations (F) of CMU text.

    The database rotates the root by R = Rz · Ry · Rx. The text was made by multiplying the same
    three angles as Rz · Rx · Ry. The two products are nearly equal for someone who faces +Z; while
    the heading passes 90°, the person in the text lies on the floor. The three angles are recovered
    from the text's rotation and multiplied in the right order. Trial 02_01 exists as an Acclaim
    file too: its root then agrees within 2e-6 radians, without the correction within 1.3e-2.

    The angles (z, x, y) and (z + π, π - x, y + π) are the same rotation in the text's order, but
    not in the database's. So the angles are chosen to be continuous from frame to frame.
    """
    zxy = quaternions.to_angles("ZXY", text)
    steps = quaternions.angle(quaternions.product(text[1:], quaternions.inverse(text[:-1])))
    parts = np.split(zxy, np.flatnonzero(steps > _CUT) + 1)
    for part in parts:  # a part is a view: assigning to it changes zxy
        if abs(part[0, 2]) > np.pi / 2:  # the database begins with y between -90° and 90°
            part[0] = part[0] * [1, -1, 1] + np.pi
        part[:] = quaternions.continuous_angles(part)
    z, x, y = zxy.T
    return quaternions.from_angles("ZYX", np.stack([z, y, x], axis=1))
