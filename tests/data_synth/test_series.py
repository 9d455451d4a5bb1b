"""Series of takes: how much, who, the files that come out, and the command line."""

import csv
import json

import numpy as np
import pytest
from acclaim_files import FILES

import data_synth.__main__ as command_line
from data_synth import KINDS, Plan, make_takes, plan_cmu_scale, plan_takes, write_series
from numpy_cae.mocap import load_motion

REFUSED = json.loads((FILES / "synthetic.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("minutes", [0.05, 1.0, 30.0])
def test_a_series_lasts_as_long_as_asked(minutes):
    plans = plan_takes(minutes, seed=4)
    assert sum(plan.seconds for plan in plans) == pytest.approx(60 * minutes)
    assert max(plan.seconds for plan in plans) <= 23
    assert [plan.number for plan in plans] == list(range(1, len(plans) + 1))


def test_a_take_can_be_made_without_those_before_it():
    plans = plan_takes(0.5, seed=6)
    for take, plan in zip(make_takes(0.5, seed=6, rate=30.0), plans, strict=True):
        again = plan.make(30.0)
        assert take.motion.rotations.tobytes() == again.motion.rotations.tobytes()


def test_cmu_scale_is_the_paper_s_number_of_windows():
    plans = plan_cmu_scale(seed=1)
    assert len(plans) == 2605
    frames = np.array([round(plan.seconds * 30) for plan in plans])
    windows = np.where(frames < 160, 1, 1 + np.ceil((frames - 160) / 80))
    assert windows.sum() == 9673
    assert 6 < sum(plan.seconds for plan in plans) / 3600 < 10


def test_files_read_back_to_the_same_positions(tmp_path):
    plans = [Plan(9, n, (n - 1) // 12 + 1, kind, 0.8) for n, kind in enumerate(KINDS, start=1)]
    write_series(plans, tmp_path, rate=60.0)
    with (tmp_path / "labels.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["kind"] for row in rows] == list(KINDS)
    for plan, row in zip(plans, rows, strict=True):
        take, read = plan.make(60.0), load_motion(tmp_path / row["file"])
        assert (len(read), read.rate) == (len(take.motion), pytest.approx(60.0, rel=1e-6))
        assert int(row["frames"]) == len(read)
        order = [read.skeleton.index(name) for name in take.motion.skeleton.names]
        off = read.positions()[:, order] - take.motion.positions()
        assert np.abs(off).max() < 1e-3


def test_the_command_writes_a_folder(tmp_path, capsys):
    out = tmp_path / "deep" / "motions"
    arguments = ["--minutes", "0.2", "--seed", "3", "--rate", "30", "--kinds", "walk, wave"]
    assert command_line.main([str(out), *arguments]) == 0
    said = capsys.readouterr()
    assert "0.2 minutes" in said.out
    assert {path.suffix for path in out.rglob("*.*")} == {".bvh", ".csv"}


def test_more_minutes_than_anybody_needs_are_refused(tmp_path, capsys):
    assert command_line.main([str(tmp_path), "--minutes", "1e300"]) == 2
    assert "expected at most 100000" in capsys.readouterr().err


def test_a_file_of_the_users_is_not_replaced(tmp_path, capsys):
    words = [str(tmp_path), "--minutes", "0.1", "--quiet"]
    assert command_line.main(words) == command_line.main(words) == 0  # the same bytes
    file = next(tmp_path.glob("*/*.bvh"))
    file.write_text("mine")
    assert command_line.main(words) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert file.read_text() == "mine"
    assert command_line.main([*words, "--overwrite"]) == 0
    assert file.read_text() != "mine"


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path, capsys):
    (tmp_path / "file").write_text("in the way")
    assert command_line.main([str(tmp_path / "file" / "out"), "--minutes", "0.1", "--quiet"]) == 2
    message = capsys.readouterr().err
    assert message.startswith("data_synth: ") and "cannot be made" in message
    assert message.count("\n") == 1


@pytest.mark.parametrize(("arguments", "message"), REFUSED["command"])
def test_wrong_arguments_are_said(tmp_path, capsys, arguments, message):
    with pytest.raises(SystemExit) as stopped:
        command_line.main([str(tmp_path), *arguments.split()])
    assert stopped.value.code == 2
    assert message in capsys.readouterr().err
