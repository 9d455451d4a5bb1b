"""Times: what the model recorded, scaled as the sentence says, and rehearsed where it did not."""

from dataclasses import replace

import pytest

from numpy_cae.experiments import times as clock
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.times import times


@pytest.fixture(scope="module", autouse=True)
def few_rounds():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(clock, "ROUNDS", 3)
        yield


@pytest.fixture(scope="module")
def timed(small_manifold, labelled):
    return times(small_manifold, labelled)


def test_training_is_as_recorded_and_scaled_to_the_paper(timed, small_manifold):
    settings = small_manifold.settings
    assert not timed.rehearsed
    assert timed.seconds == settings["seconds"]
    assert timed.epochs == {"layer 1": 2, "layer 2": 2, "fine tuning": 3}
    windows = settings["windows"]
    minutes = settings["seconds"]["fine tuning"] / 60 * (9673 / windows) * (25 / 3)
    assert timed.scaled("fine tuning") == pytest.approx(minutes)
    assert timed.total > minutes


def test_a_model_that_does_not_know_is_rehearsed(small_manifold, labelled):
    kept = {key: value for key, value in small_manifold.settings.items() if key != "seconds"}
    rehearsed = times(replace(small_manifold, settings=kept), labelled)
    assert rehearsed.rehearsed
    assert "rehearsed" in rehearsed.text()
    assert set(rehearsed.epochs.values()) == {1}
    assert list(rehearsed.seconds) == ["layer 1", "layer 2", "fine tuning"]
    assert all(seconds > 0 for seconds in rehearsed.seconds.values())


def test_projection_is_timed_and_findings_follow(timed, tmp_path):
    encode, project, whole = (each.median for each in timed.projection.values())
    assert 0 < encode < project
    assert whole > 0
    training, projection = timed.findings()
    assert training.held == (timed.total <= 43 + 51 + 77 + 133)
    assert projection.held == (encode < 1e-3)
    assert f"{1e3 * encode:.2f}" in timed.text()
    timed.save_picture(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_nothing_held_out_nothing_to_project(small_manifold, labelled):
    with pytest.raises(ValueError, match="a held-out take"):
        times(small_manifold, Material(labelled.training, []))
