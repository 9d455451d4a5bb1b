"""Projections on bones of constant length: exact lengths, standing feet."""

import numpy as np

from data_synth import make_take
from numpy_cae.manifold import starter
from numpy_cae.mocap import body_of
from studies import constrained_projection as study
from studies.shared.material import LabelledTake


def test_constrained_projection_keeps_lengths_and_standing_feet():
    manifold = starter()
    take = LabelledTake(None, body_of(make_take("walk", 99, 2.0, 30.0).motion))
    motions = study._motions(manifold, take, 0.0, np.random.default_rng(0))
    _, plain, kept = study._measured(manifold, motions)
    assert kept[1] < 1e-9 < plain[1]
    assert kept[2] < plain[2] / 5
    assert kept[0] < 1.1 * plain[0]
