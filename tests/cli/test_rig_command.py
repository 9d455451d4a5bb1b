"""Files of other rigs, axes and floors at the command line."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.motion import JOINTS, find_joints, load_motion, write_bvh
from numpy_cae.motion.axes import as_in_file

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


def test_a_result_has_the_axes_and_the_floor_of_its_file(strange, run, model, tmp_path):
    mapping, out = tmp_path / "a.json", tmp_path / "fixed.bvh"
    run("rig", strange[0], "-o", mapping)
    coordinates = ("--up", "z", "--floor", 0.3, "--unit", 0.01, "--mapping", mapping)
    run("interpolate", strange[0], strange[0], "-m", model, "-o", out, *coordinates)
    fixed, came = (load_motion(path, 0.01, up="y", floor=0) for path in (out, strange[0]))
    assert fixed.skeleton.names == came.skeleton.names
    lowest = fixed.positions()[..., 2].min(), came.positions()[..., 2].min()
    assert abs(lowest[0] - lowest[1]) < 0.2 and lowest[1] > 0.25
    again = as_in_file(load_motion(out, 0.01, up="z", floor=0.3))
    np.testing.assert_allclose(again.positions(), fixed.positions(), atol=1e-9)
