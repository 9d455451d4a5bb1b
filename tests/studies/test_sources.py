"""One source left out of training and measured on."""

from functools import partial

import numpy as np

from data_synth import plan_takes, write_series
from numpy_cae.manifold import learn_manifold
from numpy_cae.training import Schedule, Stage
from studies import sources


def test_each_folder_is_left_out_once(tmp_path, monkeypatch):
    quick = Schedule(Stage(epochs=0), Stage(epochs=1, rescaled=True), initial="passing", rms=0.1)
    monkeypatch.setattr(sources, "recipe", lambda name: quick)
    small = partial(learn_manifold, window=32, overlap=16, filters=(4, 6, 8), taps=5)
    monkeypatch.setattr(sources, "learn_manifold", small)
    monkeypatch.setattr("numpy_cae.manifold.weighted_completion.MOST_TRIALS", 1)
    monkeypatch.setattr(sources, "WINDOWS", 2)
    monkeypatch.setattr(sources, "SEEDS", 1)
    monkeypatch.setattr(sources, "PS", (0.5, 0.9))
    for kind in ("walk", "squats"):
        write_series(plan_takes(0.4, 1, [kind]), tmp_path / kind, rate=30.0)
    result = sources.run([tmp_path / "walk", tmp_path / "squats"])
    captions = [table.caption for table in result.tables]
    assert captions[0] == "walk, left out:" and captions[3].startswith("squats, later takes")
    for table in result.tables:
        means = {row[0]: [float(cell.split()[0]) for cell in row[1:]] for row in table.rows}
        assert len(set(means.pop("the mean pose"))) == 1 and len(means) == 12
        assert np.all(np.diff(list(means.values()), axis=1) > 0)
    assert [claim.of for claim in result.claims] == ["walk", "squats"]
