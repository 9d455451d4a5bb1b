"""Mutated findings and rosters, and short clips at high rates: used, or refused in one line.

pytest -m thorough tests/test_mutated_inputs.py takes two minutes of processor time: a clip 0.11 s,
a mutated text 1 to 3 ms.
"""

import json
from argparse import Namespace
from dataclasses import replace

import numpy as np
import pytest
from mutations import mutated

from data_synth import make_take
from numpy_cae.cleanup import repair_motion
from numpy_cae.cli.shared.damage_options import chosen_findings
from numpy_cae.course.marks.roster import read_roster
from numpy_cae.errors import NumpyCaeError

WALK = make_take("walk", 0, 2.0, 30.0).motion
RATES = 24, 60, 100, 120, 240, 500, 1000, 2000
ROSTERS = [
    "student\nann\nbob\n",
    "Identifier;Full name;ID number\nParticipant 12;Ann Lee;\nParticipant 345;Bob É;\n",
    'Student,ID,SIS Login ID,tanh\n    Points,,,4\n"Lee, Ann",12,ann,excused\n"Bo, Z",3,zoe,1\n',
]
MARKS = '[{"joint": "left_wrist", "frames": [9, 12]}, {"limb": "left_leg"}, {"frames": [5, 6]}]'


def clip(rng, rate):
    """A clip of at most 60 frames with one joint turned and one step of the root."""
    motion = WALK.at(np.arange(rng.integers(1, 61)))
    joint, frame = rng.integers(motion.rotations.shape[1]), rng.integers(len(motion))
    turn = rng.normal(size=4)
    motion.rotations[frame : frame + rng.integers(1, 5), joint] = turn / np.linalg.norm(turn)
    motion.translations[rng.integers(len(motion)) :, 0] += rng.normal(size=3)
    return replace(motion, rate=float(rate))


def mend(motion, findings=None):
    repaired = repair_motion(motion, None, findings=findings).motion
    assert len(repaired) == len(motion)
    assert np.isfinite(repaired.rotations).all() and np.isfinite(repaired.translations).all()


DAMAGED = clip(np.random.default_rng(8), 30)
FOUND = json.dumps([each.to_json() for each in repair_motion(DAMAGED, None).findings], indent=1)


def use_findings(path):
    options = Namespace(joint=[], limb=[], frames=None, mask=path)
    mend(DAMAGED, chosen_findings(options, DAMAGED))


def use_roster(path):
    roster = read_roster(path)
    assert roster.students
    roster.write(path.with_name("again.csv"), list(roster.students.values()))


@pytest.mark.parametrize("count", [12, pytest.param(500, marks=pytest.mark.thorough)])
def test_short_clips_at_high_rates(count):
    for number in range(count):
        rng = np.random.default_rng([3, number])
        mend(clip(rng, rng.choice(RATES)))


@pytest.mark.parametrize("times", [1, pytest.param(300, marks=pytest.mark.thorough)])
@pytest.mark.parametrize(("texts", "use"), [([FOUND, MARKS], use_findings), (ROSTERS, use_roster)])
def test_mutated_text(tmp_path, texts, use, times, counted):
    path, count, used = tmp_path / "input", 40 * times, 0
    for number in range(count):
        text = texts[number % len(texts)].encode()
        data, names = mutated(text, np.random.default_rng([4, number]))
        path.write_bytes(data)
        try:
            use(path)
            used += 1
        except (NumpyCaeError, ValueError) as refused:
            message = str(refused)
            assert str(path) in message and "\n" not in message, (number, names, message)
    assert 0 < used < count
    if times > 1:
        counted(f"{use.__name__}: {count} mutations, {used} used, {count - used} refused")
