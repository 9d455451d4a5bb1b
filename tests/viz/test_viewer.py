"""The viewer's page: what is packed is what was drawn, small, and safe to embed."""

import base64
import json
import re
import zlib
from dataclasses import replace

import numpy as np

from numpy_cae.motion import JOINTS, PARENTS
from numpy_cae.viz import Actor, save_viewer
from numpy_cae.viz.viewer import fragment, head


def walking(frames=60, names=JOINTS, **more):
    """Random joints around a root that walks 100 m."""
    rng = np.random.default_rng(0)
    body = rng.uniform(-0.9, 0.9, size=(frames, len(JOINTS), 3)).cumsum(axis=0) / 50
    body[..., 0] += np.linspace(0, 100, frames)[:, None]
    return Actor(body, PARENTS, "walk", names=tuple(names), **more)


def data_of(html):
    return json.loads(re.search(r"<script type=.application/json.[^>]*>(.*?)</script>", html)[1])


def positions_of(data):
    """World positions (F, J, 3) of each motion of a page."""
    unpacked = []
    for packed in data["motions"]:
        planes = zlib.decompress(base64.b64decode(packed["steps"]))
        signed = np.frombuffer(planes, np.uint8).reshape(4, -1).T.copy().view("<u4")
        differences = ((signed >> 1) ^ -(signed & 1).astype(np.int32)).astype(np.int32)
        steps = differences.reshape(-1, data["frames"]).cumsum(axis=1)
        unpacked.append(steps + unpacked[0] if packed["from_first"] else steps)
    bodies = [steps.T.reshape(data["frames"], -1, 3) for steps in unpacked]
    for body in bodies:
        body[:, 1:] += body[:, :1]
    return [body * packed["step"] for body, packed in zip(bodies, data["motions"], strict=True)]


def test_positions_are_kept_within_two_roundings_of_0_4_mm():
    actors = [walking(), replace(walking(), positions=walking().positions[::-1]), walking(60)]
    for positions, actor in zip(positions_of(data_of(fragment(actors, 30.0))), actors, strict=True):
        assert np.abs(positions - actor.positions).max() < 4e-4  # root and joint: two roundings


def test_a_name_cannot_end_the_script():
    names = ("</script><b>", *JOINTS[1:])
    html = fragment([walking(names=names)], 30.0)
    assert html.count("</script>") == 1
    assert data_of(html)["motions"][0]["names"][0] == "</script><b>"


def test_the_shorter_motion_holds_its_last_pose():
    data = data_of(fragment([walking(60), walking(20)], 30.0))
    held = positions_of(data)[1]
    assert len(held) == data["frames"] == 60
    np.testing.assert_array_equal(held[20:], np.repeat(held[19:20], 40, axis=0))


def test_distances_and_findings_are_in_the_page():
    """Distances on a scale of logarithms from 1 to 50 cm; a level of 0 is below it."""
    moved = np.zeros((60, 20))
    moved[10:14, 3] = 0.0099, 0.01, 0.0707, 0.5
    levels = [0, 1, 128, 255]
    found = {"joint": "head", "frames": [10, 19], "kind": "spike", "cm": 20.0}
    data = data_of(fragment([walking(moved=moved)], 30.0, findings=[found], command="repair"))
    assert (data["scale"], data["findings"], data["command"]) == ([0.01, 0.5], [found], "repair")
    packed = zlib.decompress(base64.b64decode(data["motions"][0]["moved"]))
    assert np.frombuffer(packed, np.uint8).reshape(20, 60)[3, 9:15].tolist() == [0, *levels, 0]


def test_a_page_needs_no_network_and_is_small(tmp_path):
    minute = [walking(1800), walking(1800)]
    save_viewer(minute, tmp_path / "page.html", 30.0)
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)=["']?https?:""", page)
    assert len(page) - len(head()) < 1e6
