"""Sequential samples on the convolutional manifold: what is measured is what it says."""

import numpy as np

from data_synth import make_take
from numpy_cae.experiments.actions import Action
from numpy_cae.experiments.both_worlds import CONSTRAINED, NOT, PLAINLY, both_worlds
from numpy_cae.experiments.sequence_study import Study
from numpy_cae.manifold import learn_sequences
from numpy_cae.motion import angles_of
from numpy_cae.training import SequenceSchedule


def test_samples_before_and_after(small_manifold, tmp_path, monkeypatch):
    for name, fewer in (("CLIPS", 2), ("OTHERS", 6), ("STEPS", 5)):
        monkeypatch.setattr(f"numpy_cae.experiments.both_worlds.{name}", fewer)
    takes = [angles_of(make_take("walking", seed, 4.0, 25.0).motion) for seed in range(4)]
    short = SequenceSchedule(epochs=1, steps=4, batch=8, directions=4)
    manifold = learn_sequences(takes[:2], short, hidden=8, latent=4, show_progress=False)
    action = Action("walking", takes[:2], takes[2:], periodic=True)
    result = both_worlds(Study(action, manifold), small_manifold)
    rows = result.rows
    assert len(rows) == 6
    for source in ("samples", "real clips"):
        # Angles keep bones by themselves, a plain projection does not, the last step does.
        assert rows[f"{source}, {NOT}"].bones < 0.2
        assert rows[f"{source}, {PLAINLY}"].bones > rows[f"{source}, {CONSTRAINED}"].bones
    real, sampled = rows[f"real clips, {NOT}"], rows[f"samples, {NOT}"]
    assert real.first_written < sampled.first_written and real.clip < sampled.clip
    drifts, mends, feet = result.findings()
    assert drifts.held == (sampled.last_written > sampled.first_written)
    assert f"{sampled.clip:.2f}" in mends.measured
    assert feet.held in (True, False) and "samples, projected" in result.text()
    assert {*result.shown} == {NOT, PLAINLY, CONSTRAINED}
    assert all(np.isfinite(x).all() for x in result.shown.values())
    result.save_picture(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000
