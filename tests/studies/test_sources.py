"""One source left out of training and measured on."""

from data_synth import plan_takes, write_series
from numpy_cae.training import Schedule, Stage
from studies import sources


def test_each_folder_is_left_out_once(tmp_path, monkeypatch):
    quick = Schedule(Stage(epochs=0), Stage(epochs=1, rescaled=True), initial="passing", rms=0.1)
    monkeypatch.setattr(sources, "recipe", lambda name: quick)
    for kind in ("walk", "squats"):
        write_series(plan_takes(0.2, 1, [kind]), tmp_path / kind, rate=30.0)
    rows = sources.run([tmp_path / "walk", tmp_path / "squats"]).tables[0].rows
    assert [row[0] for row in rows] == 6 * ["walk"] + 6 * ["squats"]
    assert all(0 <= row[2] < 1000 and 0 < row[3] < 1000 for row in rows)
