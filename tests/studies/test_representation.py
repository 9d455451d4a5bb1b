"""Projections on bones of constant length: exact lengths, standing feet; unpoolings as inverses;
how many columns have most of the energy."""

import numpy as np

from data_synth import make_take
from numpy_cae.evaluation import position_error
from numpy_cae.manifold import starter
from numpy_cae.mocap import body_of
from numpy_cae.motion import features_to_positions
from numpy_cae.motion.contacts import find_contacts
from studies.representation import (
    AGAIN,
    BEFORE,
    EVEN,
    RANDOM,
    REPEATED,
    _constrain,
    _sliding,
    count_columns,
)
from studies.shared.validity import bone_length_error


def test_constraints_keep_lengths_and_standing_feet():
    manifold = starter()
    truth, _ = manifold.features(body_of(make_take("walk", 99, 2.0, 30.0).motion))
    plain = manifold.project(truth, average_shifts=True)
    stands = find_contacts(features_to_positions(plain), manifold.rate)
    kept = _constrain(manifold, plain)
    assert bone_length_error(features_to_positions(kept), manifold.lengths) < 1e-9
    assert _sliding(kept, stands) < _sliding(plain, stands) / 5
    assert position_error(kept, truth) < 1.1 * position_error(plain, truth)


def test_the_shares_that_unpooling_leaves(result_of):
    """Pooled again, an even unpooling has half of the value, and the value on both frames all."""
    table = result_of("representation").tables[2]
    for layer in ("layer 1", "layer 2"):
        assert abs(table.value(f"{AGAIN}: {EVEN}", layer) - 0.25) < 1e-6
        assert table.value(f"{AGAIN}: {REPEATED}", layer) == 0
        # what random unpooling leaves are the negative values
        assert 0 < table.value(f"{AGAIN}: {RANDOM}", layer) < 1
        assert table.value(f"{BEFORE}: {RANDOM}", layer) > table.value(f"{BEFORE}: {EVEN}", layer)


def test_columns_with_most_of_the_energy_are_counted():
    energy = np.array([[0.0, 5.0, 0.0, 0.0], [1.0, 1.0, 1.0, 1.0], [1.0, 94.0, 1.0, 4.0]])
    np.testing.assert_array_equal(count_columns(energy), [1, 4, 1])
