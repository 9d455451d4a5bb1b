"""Rotation vectors without jumps."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from numpy_cae.motion.angles import shortest_clips, unwrapped

seeds = st.integers(0, 2**32 - 1)


def wrapped(vectors):
    """As a reader of rotations gives them: none longer than π."""
    return Rotation.from_rotvec(vectors.reshape(-1, 3)).as_rotvec().reshape(vectors.shape)


def equal_rotations(a, b):
    gap = Rotation.from_rotvec(a.reshape(-1, 3)).inv() * Rotation.from_rotvec(b.reshape(-1, 3))
    return gap.magnitude().max() < 1e-9


@given(seeds)
def test_the_same_rotations_without_a_jump(seed):
    rng = np.random.default_rng(seed)
    # Three joints that turn far about axes which drift slowly, never through no rotation at all.
    angle = rng.uniform(0.5, 9.0, 3) + np.linspace(0, 1, 100)[:, None] * rng.uniform(0, 9, 3)
    axis = rng.normal(size=(1, 3, 3)) + 0.002 * np.cumsum(rng.normal(size=(100, 3, 3)), axis=0)
    axis /= np.linalg.norm(axis, axis=-1, keepdims=True)
    smooth = angle[..., None] * axis
    found = unwrapped(wrapped(smooth))
    assert equal_rotations(found, smooth)
    steps = np.linalg.norm(np.diff(smooth, axis=0), axis=-1).max()
    assert np.linalg.norm(np.diff(found, axis=0), axis=-1).max() < 2 * steps + 1e-9


def test_an_exact_identity_on_the_way_keeps_the_turn():
    smooth = np.array([[0.0, 6.0, 0.0], [0.0, 2 * np.pi, 0.0], [0.0, 6.6, 0.0]])
    angle = wrapped(smooth)
    angle[1] = 0.0
    assert np.allclose(unwrapped(np.concatenate([smooth[:1], angle[1:]])), smooth, atol=1e-9)


def test_what_does_not_jump_is_left_alone():
    calm = np.random.default_rng(0).normal(0, 0.2, (50, 4, 3))
    assert np.array_equal(unwrapped(calm), calm)
    assert np.array_equal(shortest_clips(calm), calm)


@given(seeds, st.integers(-3, 3))
def test_a_clip_forgets_turns_made_before_it(seed, turns):
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    clip = (rng.uniform(0.5, 2.5) + 0.2 * np.sin(np.linspace(0, 6, 50)))[:, None, None] * axis
    later = clip * (1 + 2 * np.pi * turns / np.linalg.norm(clip, axis=-1, keepdims=True))
    assert equal_rotations(shortest_clips(later), clip)
    assert np.allclose(shortest_clips(later), clip, atol=1e-9)
