"""What cannot be learned from, or could not be loaded again, is refused, by the argument's name."""

from dataclasses import replace

import numpy as np
import pytest

from numpy_cae.array_file import ModelFileError
from numpy_cae.manifold import learn_manifold, load_manifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import Schedule, SequenceSchedule, Stage
from numpy_cae.training.divergence import DivergedError

TINY = {"window": 16, "filters": (4, 6), "taps": 5}
SHORT = Schedule(Stage(epochs=1), Stage(epochs=1))


def test_a_model_that_could_not_be_loaded_is_not_saved(tiny_manifolds, tmp_path):
    manifold = tiny_manifolds[0]["conv"]
    far = replace(manifold, mean_pose=np.full(63, 1e300))
    with pytest.raises(ModelFileError, match="mean_pose"):
        far.save(tmp_path / "model.npz")
    assert not any(tmp_path.iterdir())


def test_a_sequential_model_that_could_not_be_loaded_is_not_saved(tiny_manifolds, tmp_path):
    manifold = tiny_manifolds[0]["sequence"]
    far = replace(manifold, mean=np.full_like(manifold.mean, 1e300))
    with pytest.raises(ModelFileError, match="mean"):
        far.save(tmp_path / "model.npz")
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("half", [False, True])
def test_what_is_saved_can_be_loaded(half, tiny_manifolds, tmp_path):
    tiny_manifolds[0]["conv"].save(tmp_path / "model.npz", half=half)
    assert load_manifold(tmp_path / "model.npz").stride == 4


def test_a_training_that_diverges_to_large_numbers_says_so(walk_takes):
    stage = Stage(epochs=1, rate=1e6, norm=1e3)
    with np.errstate(all="ignore"), pytest.raises(DivergedError, match="lower rate"):
        learn_manifold(walk_takes[:2], Schedule(stage, stage), **TINY)


@pytest.mark.parametrize("bound", [0.0, 1.0, -0.5, np.nan])
def test_a_bound_that_no_file_may_have_is_refused(bound):
    with pytest.raises(ValueError, match="bound"):
        ConvAutoencoder(filters=(4,), taps=5, bound=bound)


@pytest.mark.parametrize(
    ("name", "value"), [("taps", 4), ("taps", 0), ("filters", (0, 0)), ("filters", ())]
)
def test_a_size_that_no_network_has_is_refused(name, value, walk_takes):
    with pytest.raises(ValueError, match=name):
        learn_manifold(walk_takes[:2], SHORT, **TINY | {name: value})


@pytest.mark.parametrize(
    "take",
    [
        np.zeros((0, 20, 3)),
        np.zeros((9, 60)),
        np.zeros((9, 19, 3)),
        [[1, 2], [3, 4]],
        np.full((9, 20, 3), np.nan),
        np.full((9, 20, 3), np.inf),
    ],
    ids=["no frame", "flat", "19 joints", "lists", "nan", "inf"],
)
def test_a_take_of_another_shape_is_refused(take, walk_takes):
    with pytest.raises(ValueError, match=r"takes\[1\]"):
        learn_manifold([walk_takes[0], take], SHORT, **TINY)


def test_millimetres_are_no_metres(walk_takes):
    with pytest.raises(ValueError, match="metres"):
        learn_manifold([1000 * walk_takes[0]], SHORT, **TINY)


def test_takes_may_come_from_a_generator(walk_takes):
    manifold = learn_manifold((take for take in walk_takes[:2]), SHORT, **TINY)
    assert manifold.settings["takes"] == 2


@pytest.mark.parametrize("positions", [np.zeros((0, 20, 3)), np.zeros((9, 60))])
def test_positions_of_another_shape_are_refused(positions, tiny_manifolds):
    with pytest.raises(ValueError, match="positions"):
        tiny_manifolds[0]["conv"].features(positions)


def test_features_of_another_shape_are_refused(tiny_manifolds):
    with pytest.raises(ValueError, match="features"):
        tiny_manifolds[0]["conv"].project(np.zeros((9, 60)))


@pytest.mark.parametrize("schedule", [Stage, SequenceSchedule])
@pytest.mark.parametrize(
    ("name", "value"), [("epochs", -1), ("batch", 0), ("rate", -1.0), ("rate", np.nan)]
)
def test_a_number_that_no_schedule_has_is_refused(schedule, name, value):
    with pytest.raises(ValueError, match=name):
        schedule(**{name: value})
