"""Motions written as glTF and as tables hold the positions of the motion; C3D files are read."""

import json
import shutil
import struct
import subprocess

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from data_synth import make_take
from numpy_cae.motion import JOINTS, MotionFileError, body_positions, load_motion, write_motion


@pytest.fixture(scope="module")
def motion():
    return make_take("walk", 3, seconds=2.0, rate=30.0).motion


def gltf_positions(path):
    """World positions (F, J, 3) of the skin's joints, by glTF's rules, and the mesh's at rest."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    parts, binary = json.loads(data[20 : 20 + length]), data[28 + length :]

    def array(accessor):
        entry = parts["accessors"][accessor]
        view = parts["bufferViews"][entry["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[entry["type"]]
        kind = {5126: "<f4", 5123: "<u2"}[entry["componentType"]]
        count = entry["count"] * width
        return np.frombuffer(binary, kind, count, view["byteOffset"]).reshape(-1, width)

    joints, nodes = parts["skins"][0]["joints"], parts["nodes"]
    animation = parts["animations"][0]
    frames = len(array(animation["samplers"][0]["input"]))
    moves = {
        (channel["target"]["node"], channel["target"]["path"]): array(
            animation["samplers"][channel["sampler"]]["output"]
        )
        for channel in animation["channels"]
    }
    positions = np.zeros((frames, len(joints), 3))

    def place(node, rotation, position):
        at_rest = np.tile(nodes[node]["translation"], (frames, 1))
        position = position + rotation.apply(moves.get((node, "translation"), at_rest))
        positions[:, node] = position
        rotation = rotation * Rotation.from_quat(moves[node, "rotation"])
        for child in nodes[node].get("children", []):
            place(child, rotation, position)

    place(joints[0], Rotation.identity(frames), np.zeros(3))
    return positions


def test_gltf_moves_as_the_motion_does(motion, tmp_path):
    write_motion(motion, tmp_path / "walk.glb")
    np.testing.assert_allclose(gltf_positions(tmp_path / "walk.glb"), motion.positions(), atol=1e-5)


def test_gltf_passes_the_validator_of_khronos(motion, tmp_path):
    npm = shutil.which("npm")
    if npm is None or shutil.which("node") is None:
        pytest.skip("needs node and npm")
    wanted = [npm, "install", "--no-audit", "--prefix", str(tmp_path), "gltf-validator"]
    if subprocess.run(wanted, capture_output=True, timeout=120, check=False).returncode:
        pytest.skip("gltf-validator cannot be installed")
    write_motion(motion, tmp_path / "walk.glb")
    script = (
        "require('gltf-validator').validateBytes(new Uint8Array(require('fs')"
        ".readFileSync('walk.glb'))).then(found => console.log(JSON.stringify(found.issues)))"
    )
    ran = subprocess.run(["node", "-e", script], cwd=tmp_path, capture_output=True, check=True)
    issues = json.loads(ran.stdout)
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"]


def test_tables_hold_the_positions(motion, tmp_path):
    write_motion(motion, tmp_path / "walk.npz")
    with np.load(tmp_path / "walk.npz") as archive:
        np.testing.assert_array_equal(archive["positions"], motion.positions())
        assert tuple(archive["names"]) == motion.skeleton.names
        assert archive["rate"] == 30
    write_motion(motion, tmp_path / "walk.csv")
    table = np.genfromtxt(tmp_path / "walk.csv", delimiter=",", names=True, deletechars="")
    head = motion.positions()[:, motion.skeleton.names.index("head"), 1]
    np.testing.assert_allclose(table["head_y"], head, atol=1e-6)
    np.testing.assert_allclose(table["time"], np.arange(len(motion)) / 30, atol=1e-6)


def test_another_suffix_is_refused(motion, tmp_path):
    with pytest.raises(ValueError, match=r"fbx: a motion is written as \.bvh, \.glb"):
        write_motion(motion, tmp_path / "walk.fbx")


def write_c3d(path, points, labels, up="+Z"):
    """Points (F, N, 3) in metres, Z up, as millimetres."""
    content = pytest.importorskip("ezc3d", reason="needs the extra `c3d`").c3d()
    content["parameters"]["POINT"]["RATE"]["value"] = [30.0]
    content["parameters"]["POINT"]["LABELS"]["value"] = list(labels)
    content["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    content.add_parameter("POINT", "Y_SCREEN", up)
    rows = np.ones((4, points.shape[1], len(points)))
    rows[:3] = 1000 * points.transpose(2, 1, 0)
    content["data"]["points"] = rows
    content.write(str(path))


def test_joint_centres_of_a_c3d_file_are_read(motion, tmp_path):
    positions = body_positions(motion)
    points = np.concatenate([positions[..., [2, 0, 1]], np.ones((len(positions), 1, 3))], axis=1)
    points[10:14, 3] = np.nan
    write_c3d(tmp_path / "walk.c3d", points, [*JOINTS, "extra"])
    read = load_motion(tmp_path / "walk.c3d")
    assert (read.rate, read.unit, len(read)) == (30.0, 0.001, len(motion))
    assert np.abs(body_positions(read) - positions).max() < 0.03
    write_c3d(tmp_path / "markers.c3d", points[:, :5], ["LFHD", "RFHD", "C7", "CLAV", "STRN"])
    with pytest.raises(MotionFileError, match="centres of the 20 joints"):
        load_motion(tmp_path / "markers.c3d")
