"""One source left out of training and measured on."""

import sources

from data_synth import make_take
from numpy_cae.motion import write_bvh
from numpy_cae.training import Schedule, Stage


def test_each_folder_is_left_out_once(tmp_path, monkeypatch):
    quick = Schedule(Stage(epochs=0), Stage(epochs=1, rescaled=True), initial="passing", rms=0.1)
    monkeypatch.setattr(sources, "recipe", lambda name: quick)
    for kind, seed in (("walk", 0), ("walk", 1), ("squats", 0), ("squats", 1)):
        (tmp_path / kind).mkdir(exist_ok=True)
        write_bvh(make_take(kind, seed, 6.0, 30.0).motion, tmp_path / kind / f"{seed}.bvh", 0.01)
    rows = sources.run([tmp_path / "walk", tmp_path / "squats"]).tables[0].rows
    assert [row[0] for row in rows] == 4 * ["walk"] + 4 * ["squats"]
    assert all(0 < min(row[2:]) <= max(row[2:]) < 1000 for row in rows)
