"""Files of other rigs, axes and floors at the command line."""

import json
import re
from dataclasses import replace

import pytest

from data_synth import make_take
from numpy_cae.mocap import find_joints, write_bvh
from numpy_cae.motion import JOINTS

WALK = make_take("walk", 5, 3.0, 30.0).motion


@pytest.fixture
def strange(tmp_path):
    """A file of meaningless names, Z up, 30 cm above its floor, and one of other names."""
    paths = tmp_path / "a.bvh", tmp_path / "b.bvh"
    for path, word in zip(paths, ("bone", "part"), strict=True):
        names = tuple(f"{word} {number}" for number in range(len(WALK.skeleton.names)))
        motion = replace(WALK, skeleton=replace(WALK.skeleton, names=names), up="z", floor=0.3)
        write_bvh(motion, path, unit=0.01)
    return paths


def test_rig_prints_what_a_file_is_and_writes_its_mapping(strange, run, capsys, tmp_path):
    mapping = tmp_path / "a.json"
    run("rig", strange[0], "-o", mapping)
    said = capsys.readouterr().out
    assert "90 frames at 30 a second" in said and "centimetres" in said and "up     Z" in said
    (floor,) = re.findall(r"floor  (\S+) m", said)
    assert float(floor) == pytest.approx(0.3, abs=0.06) and "unknown" in said
    names = [f"bone {joint}" for joint in find_joints(WALK.skeleton)]
    assert json.loads(mapping.read_text()) == dict(zip(JOINTS, names, strict=True))
    for joint, name in zip(JOINTS, names, strict=True):
        assert f"{joint:15} {name} (suggested by the hierarchy" in said
    run("rig", strange[0], "--mapping", mapping)
    assert "suggested" not in capsys.readouterr().out


def test_each_file_takes_the_mapping_that_fits(strange, run, error_of, walks, model, tmp_path):
    mappings = []
    for path in strange:
        mappings += ["--mapping", path.with_suffix(".json")]
        run("rig", path, "-o", mappings[-1])
    table = tmp_path / "distances.csv"
    run("compare", *strange, walks / "walk_0.bvh", "-m", model, "-o", table, *mappings)
    assert len(table.read_text().splitlines()) == 4
    message = error_of("compare", *strange, "-m", model, "-o", table, *mappings[:2])
    assert "b.bvh" in message and "hierarchy suggests" in message
