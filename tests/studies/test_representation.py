"""Projections on bones of constant length: exact lengths, standing feet; unpoolings as inverses;
how many columns have most of the energy; lengths of windows; how far the manifold is bent."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.evaluation import position_error
from numpy_cae.evaluation.tables import clips_of
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
    _change_by_turning,
    _constrain,
    _gap_of_means,
    _sliding,
    _squares_in_pieces,
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


def test_a_turned_take_has_the_same_features(small_manifold, labelled):
    assert _change_by_turning(small_manifold, labelled.testing[0].positions) < 1e-6


def test_a_take_in_windows_has_the_error_of_its_windows(small_manifold, labelled):
    """A take of two windows, without overlap."""
    take = labelled.testing[0].positions[: 2 * small_manifold.window]
    clips = clips_of(small_manifold, [take])
    windows = replace(clips, x=clips.x[::2], real=clips.real[::2], take=clips.take[::2])
    ((expected, count),) = windows.squares_by_take(small_manifold.project_windows(windows.x))
    features, _ = small_manifold.features(take)
    measured = _squares_in_pieces(small_manifold, features, small_manifold.window)
    assert measured == (pytest.approx(expected, rel=1e-4), count)


def test_a_linear_manifold_is_not_bent(small_manifold, labelled):
    class Linear:
        encode = decode = staticmethod(lambda x: x)

    x = clips_of(small_manifold, [take.positions for take in labelled.testing]).x
    assert _gap_of_means(replace(small_manifold, network=Linear()), x).value < 1e-6
    assert _gap_of_means(small_manifold, x).value > 1e-4
