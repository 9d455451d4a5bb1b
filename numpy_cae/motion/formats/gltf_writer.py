"""Write a motion as binary glTF 2.0 (.glb): a skeleton, its animation and a simple mesh of bones.

A glTF file of a skeleton alone is a tree of empty nodes in Blender, so each bone has a thin
octahedron that is skinned to its parent joint. Lengths are metres, Y up, as in `Motion`.
"""

import json
import struct
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.motion.formats.bvh_writer import require_writable
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.skeleton import Skeleton

_TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_COMPONENTS = {np.dtype("<f4"): 5126, np.dtype("<u2"): 5123}
_VERTEX_DATA, _INDEX_DATA = 34962, 34963
_MOVES = 1e-7
"""Metres. A joint that never leaves its offset by more has no animated translation."""
_THICKNESS = 0.06
"""Of a bone's length."""


def write_glb(motion: Motion, path: str | Path) -> None:
    """Write a motion to a .glb file atomically, in metres.

    Raises ValueError for a motion without frames or with values that are not finite, FileError if
    the file cannot be written.
    """
    require_writable(motion)
    document = _Document()
    skeleton = motion.skeleton
    joints = len(skeleton.names)
    nodes: list[dict] = [
        {"name": name, "translation": [float(v) for v in skeleton.offsets[joint]]}
        for joint, name in enumerate(skeleton.names)
    ]
    for joint in range(joints):
        if children := skeleton.children(joint):
            nodes[joint]["children"] = children
    nodes.append({"name": "bones", "mesh": 0, "skin": 0})
    inverse = np.tile(np.eye(4, dtype="<f4"), (joints, 1, 1))
    inverse[:, 3, :3] = -skeleton.rest_positions()  # rows, since glTF stores columns
    binds = document.add(inverse.reshape(joints, 16))
    document.parts |= {
        "scene": 0,
        "scenes": [{"nodes": [0, joints]}],
        "nodes": nodes,
        "skins": [{"joints": list(range(joints)), "skeleton": 0, "inverseBindMatrices": binds}],
        "meshes": [{"primitives": [_bones(document, skeleton)]}],
        "animations": [_animation(document, motion)],
    }
    with atomic_write(path) as beside:
        Path(beside).write_bytes(document.packed())


class _Document:
    """The JSON part and the binary part of a file while they grow."""

    def __init__(self) -> None:
        self.parts: dict = {"asset": {"version": "2.0", "generator": "numpy_cae"}}
        self.views: list[dict] = []
        self.accessors: list[dict] = []
        self.data = bytearray()

    def add(self, values: np.ndarray, target: int | None = None, bounds: bool = False) -> int:
        """Store an array (N, width) of float32 or uint16; returns its accessor."""
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes}
        self.views.append(view | ({"target": target} if target else {}))
        self.data += values.tobytes()
        self.data += bytes(-len(self.data) % 4)
        kind = {"componentType": _COMPONENTS[values.dtype], "type": _TYPES[values.shape[1]]}
        accessor = {"bufferView": len(self.views) - 1, "count": len(values)} | kind
        if bounds:
            accessor |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def packed(self) -> bytes:
        """The whole file: a header, the JSON chunk and the binary chunk."""
        buffers = {"buffers": [{"byteLength": len(self.data)}]}
        lists = {"bufferViews": self.views, "accessors": self.accessors}
        text = json.dumps(self.parts | lists | buffers, allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(self.data), b"BIN\0") + self.data
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _bones(document: _Document, skeleton: Skeleton) -> dict:
    """An octahedron from each joint to each of its children, moved by the joint."""
    rest = skeleton.rest_positions()
    ends = [(parent, rest[j]) for j, parent in enumerate(skeleton.parents) if parent >= 0]
    ends += [(joint, rest[joint] + site) for joint, site in skeleton.end_sites.items()]
    around = np.array([[0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 2]])
    faces = np.concatenate([around, np.where(around == 0, 1, around)[:, [0, 2, 1]]])
    points, moved_by, indices = [], [], []
    for number, (joint, end) in enumerate(ends):
        along = end - rest[joint]
        across = np.cross(along, np.eye(3)[np.abs(along).argmin()])
        across *= _THICKNESS * np.linalg.norm(along) / max(float(np.linalg.norm(across)), 1e-9)
        other = np.cross(along, across) / max(float(np.linalg.norm(along)), 1e-9)
        belt = rest[joint] + 0.15 * along + np.array([across, other, -across, -other])
        points += [rest[joint], end, *belt]
        moved_by += [joint] * 6
        indices.append(faces + 6 * number)
    joints = np.zeros((len(points), 4), dtype="<u2")
    joints[:, 0] = moved_by
    weights = np.tile(np.array([1, 0, 0, 0], dtype="<f4"), (len(points), 1))
    return {
        "attributes": {
            "POSITION": document.add(np.array(points, dtype="<f4"), _VERTEX_DATA, bounds=True),
            "JOINTS_0": document.add(joints, _VERTEX_DATA),
            "WEIGHTS_0": document.add(weights, _VERTEX_DATA),
        },
        "indices": document.add(np.array(indices, dtype="<u2").reshape(-1, 1), _INDEX_DATA),
    }


def _animation(document: _Document, motion: Motion) -> dict:
    """One channel for each joint's rotation, and for the translation of joints that translate."""
    times = (np.arange(len(motion)) / motion.rate).astype("<f4")[:, None]
    shared = document.add(times, bounds=True)
    offsets = np.asarray(motion.skeleton.offsets)
    moves = np.abs(motion.translations - offsets).max(axis=(0, 2)) > _MOVES
    animated = [("rotation", joint, motion.rotations[:, joint]) for joint in range(len(offsets))]
    moving = np.flatnonzero(moves).tolist()
    animated += [("translation", joint, motion.translations[:, joint]) for joint in moving]
    samplers: list[dict] = []
    channels: list[dict] = []
    for path, joint, values in animated:
        stored = document.add(np.ascontiguousarray(values, dtype="<f4"))
        channels.append({"sampler": len(samplers), "target": {"node": joint, "path": path}})
        samplers.append({"input": shared, "output": stored, "interpolation": "LINEAR"})
    return {"name": "motion", "samplers": samplers, "channels": channels}
