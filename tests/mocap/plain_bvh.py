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

    def words(values: list) -> str:
        return " ".join(map(str, values))

    def block(index: int) -> str:
        joint = joints[index]
        tip = f"End Site\n{{\nOFFSET {words(joint.tip)}\n}}\n" if joint.tip is not None else ""
        below = [block(child) for child, joint in enumerate(joints) if joint.parent == index]
        return (
            f"{'JOINT' if index else 'ROOT'} {joint.name}\n{{\nOFFSET {words(joint.offset)}\n"
            f"CHANNELS {words([len(joint.channels), *joint.channels])}\n{tip}{''.join(below)}}}\n"
        )

    rows = "".join(words(row) + "\n" for row in values)
    return f"HIERARCHY\n{block(0)}MOTION\nFrames: {len(values)}\nFrame Time: {time}\n{rows}"


def about(axis: str, degrees: float) -> np.ndarray:
    return Rotation.from_euler(axis.lower(), degrees, degrees=True).as_matrix()


def plain_positions(joints: list[PlainJoint], values: list[list[float]]) -> np.ndarray:
    """(frames, joints, 3) in units of the file."""
    frames = []
    for row in values:
        queue = iter(row)
        turned, places = [np.eye(3)], [np.zeros(3)]  # of the world, the parent of the root
        for joint in joints:
            local, reach = np.eye(3), np.array(joint.offset, dtype=float)
            for channel, value in zip(joint.channels, queue, strict=False):
                if channel.lower().endswith("position"):
                    reach["xyz".index(channel[0].lower())] = value
                else:
                    local = local @ about(channel[0], value)
            parent = joint.parent + 1
            places.append(places[parent] + turned[parent] @ reach)
            turned.append(turned[parent] @ local)
        frames.append(places[1:])
    return np.array(frames)
