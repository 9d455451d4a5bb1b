"""A loop continues only from a position that a training can have."""

from types import SimpleNamespace

import numpy as np
import pytest

from numpy_cae.training import Checkpoint
from numpy_cae.training.loop import Loop, Position


def loop():
    rng = np.random.default_rng(0)
    return Loop({"w": np.zeros(2)}, rng, SimpleNamespace(losses=[]), [])


def resume(position):
    continued = loop()
    state = np.random.default_rng(1).bit_generator.state
    continued.resume(position, {"w": np.ones(2)}, state, {"losses": [1.0]})
    return continued


def test_all_of_a_state_is_taken_over():
    continued = resume(Position(epoch=2, step=1, order=np.array([2, 0, 1])))
    np.testing.assert_array_equal(continued.parameters["w"], [1, 1])
    assert continued.history.losses == [1.0]
    assert continued.position.epoch == 2
    assert continued.rng.random() == np.random.default_rng(1).random()


@pytest.mark.parametrize(
    ("position", "part"),
    [
        (Position(stage=-1), "position"),
        (Position(epoch=0.5), "position"),
        (Position(seconds=np.nan), "position"),
        (Position(order=np.array([0.0, 1.0])), "order"),
        (Position(order=np.array([0, 0, 1])), "order"),
    ],
)
def test_a_position_that_no_training_has_is_refused(position, part):
    with pytest.raises(ValueError, match=f"the {part}.* not one of a training"):
        resume(position)


def test_within_an_epoch_a_checkpoint_is_written_only_when_the_last_one_is_old(tmp_path):
    running, written = loop(), []
    running.position, running.steps = Position(step=1), 2
    for seconds in (0.0, 600.0):
        kept = Checkpoint(tmp_path / "c.npz", seconds)
        kept.save = lambda _, seconds=seconds: written.append(seconds)
        kept.after_step(running)
    assert written == [0.0]
