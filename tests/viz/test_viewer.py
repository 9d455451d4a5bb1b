"""The viewer's page: what is packed is what was drawn, small, and safe to embed."""

import base64
import json
import re
import zlib

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


def inflated(text, kind):
    return np.frombuffer(zlib.decompress(base64.b64decode(text)), dtype=kind)


def test_positions_are_kept_within_a_tenth_of_a_millimetre():
    actor = walking()
    packed = data_of(fragment([actor], 30.0))["motions"][0]
    local = inflated(packed["local"], "<i2").reshape(60, 20, 3).cumsum(axis=0, dtype=np.int16)
    root = inflated(packed["root"], "<f4").reshape(60, 1, 3)
    positions = root.astype(float) + local * packed["step"]
    assert np.abs(positions - actor.positions).max() < 1e-4


def test_a_name_cannot_end_the_script():
    names = ("</script><b>", *JOINTS[1:])
    html = fragment([walking(names=names)], 30.0)
    assert html.count("</script>") == 1
    assert data_of(html)["motions"][0]["names"][0] == "</script><b>"


def test_the_shorter_motion_holds_its_last_pose():
    data = data_of(fragment([walking(60), walking(20)], 30.0))
    root = inflated(data["motions"][1]["root"], "<f4").reshape(60, 3)
    assert data["frames"] == 60
    np.testing.assert_array_equal(root[20:], np.repeat(root[19:20], 40, axis=0))


def test_the_timeline_shows_damage_and_movement():
    moved = np.zeros((60, 20))
    moved[10:20, 3] = 0.2
    data = data_of(fragment([walking(moved=moved, damaged=moved > 0)], 30.0))
    damaged, distance = data["tracks"]
    assert (damaged["label"], distance["label"]) == ("walk: damaged", "walk: distance from walk")
    for track in (damaged, distance):
        assert np.flatnonzero(track["values"]).tolist() == list(range(10, 20))
    assert data["furthest"] == 0.2
    packed = inflated(data["motions"][0]["moved"], np.uint8).reshape(60, 20)
    np.testing.assert_array_equal(packed == 255, moved > 0)


def test_a_page_needs_no_network_and_is_small(tmp_path):
    minute = [walking(1800), walking(1800)]
    save_viewer(minute, tmp_path / "page.html", 30.0)
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)=["']?https?:""", page)
    assert len(page) - len(head()) < 1e6
