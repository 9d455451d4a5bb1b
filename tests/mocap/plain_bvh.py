"""BVH written and posed the slow and obvious way, to hold the package's reader and writer against.

Nothing here imports the package: text by print, rotations by 3 x 3 matrices, positions by loops.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation


@dataclass
class PlainJoint:
    name: str
    parent: int
    offset: list[float]
    channels: list[str]
    tip: list[float] | None = None


def bvh_text(joints: list[PlainJoint], values: list[list[float]], time: str = "0.025") -> str:
    """The file as text, joints depth first as they come."""
    lines = ["HIERARCHY"]

    def write(index: int) -> None:
        joint = joints[index]
        lines.append(("ROOT " if index == 0 else "JOINT ") + joint.name)
        lines.append("{")
        lines.append("OFFSET " + " ".join(map(repr, joint.offset)))
        lines.append(" ".join(["CHANNELS", str(len(joint.channels)), *joint.channels]))
        if joint.tip is not None:
            lines.extend(["End Site", "{", "OFFSET " + " ".join(map(repr, joint.tip)), "}"])
        for child, other in enumerate(joints):
            if other.parent == index:
                write(child)
        lines.append("}")

    write(0)
    lines.extend(["MOTION", f"Frames: {len(values)}", f"Frame Time: {time}"])
    lines.extend(" ".join(map(repr, row)) for row in values)
    return "\n".join(lines) + "\n"


def about(axis: str, degrees: float) -> np.ndarray:
    return Rotation.from_euler(axis.lower(), degrees, degrees=True).as_matrix()


def plain_positions(joints: list[PlainJoint], values: list[list[float]]) -> np.ndarray:
    """(frames, joints, 3) in units of the file."""
    frames = []
    for row in values:
        queue = list(row)
        turned, places = [], []
        for joint in joints:
            local, reach = np.eye(3), np.array(joint.offset, dtype=float)
            for channel in joint.channels:
                value = queue.pop(0)
                if channel.lower().endswith("position"):
                    reach["xyz".index(channel[0].lower())] = value
                else:
                    local = local @ about(channel[0], value)
            if joint.parent < 0:
                turned.append(local)
                places.append(reach)
            else:
                turned.append(turned[joint.parent] @ local)
                places.append(places[joint.parent] + turned[joint.parent] @ reach)
        frames.append(places)
    return np.array(frames)
