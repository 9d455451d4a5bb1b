"""Networks that are kept by what they were trained on."""

import numpy as np
import pytest

from numpy_cae.training import Schedule, Stage
from studies.shared.trained import Trainer, hash_of


def test_a_network_is_trained_once(small_manifold, tmp_path):
    calls = []

    def train():
        calls.append(1)
        return small_manifold

    trainer = Trainer(tmp_path / "new")
    trainer.keep(train, "settings")
    again = trainer.keep(train, "settings")
    assert len(calls) == 1
    for name, weight in small_manifold.network.parameters.items():
        np.testing.assert_array_equal(again.network.parameters[name], weight)


def test_without_a_folder_nothing_is_kept(small_manifold):
    assert Trainer().keep(lambda: small_manifold, "settings") is small_manifold


TAKE = np.zeros((3, 20, 3))


@pytest.mark.parametrize(
    "settings",
    [
        (TAKE, Schedule(), 1, {}),
        (TAKE + 1, Schedule(), 0, {}),
        (TAKE[:2], Schedule(), 0, {}),
        (TAKE, Schedule(layer=Stage(epochs=1)), 0, {}),
        (TAKE, Schedule(), 0, {"taps": 1}),
    ],
)
def test_other_settings_have_another_hash(settings):
    assert hash_of(settings) != hash_of((TAKE, Schedule(), 0, {}))


def test_the_same_settings_have_the_same_hash():
    assert hash_of((TAKE.copy(), Schedule(), 0, {})) == hash_of((TAKE, Schedule(), 0, {}))
