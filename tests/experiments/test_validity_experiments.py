"""Interpolation, sampling and lengths: rows are what they say, findings follow from them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.experiments.interpolation.interpolation import (
    ALONG,
    ENDS,
    LINEAR,
    METHODS,
    SHORTEST,
    interpolation,
)
from numpy_cae.experiments.interpolation.sampling import FITTED, REAL, UNIFORM, sampling
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.experiments.repair.lengths import WHOLE, lengths
from numpy_cae.manifold import learn_manifold
from numpy_cae.motion import body_of
from numpy_cae.training import Schedule, Stage

KINDS = (("walk", "neutral"), ("press_ups", ""), ("walk", "tired"), ("walk", "brisk"))


def labelled(seed: int) -> LabelledTake:
    kind, style = KINDS[seed % len(KINDS)]
    take = make_take(kind, seed, seconds=4.0, rate=30.0, style=style or None)
    path = Path(f"{seed}.bvh")
    return LabelledTake(path, body_of(take.motion), "synthetic", kind, style or take.style)


@pytest.fixture(scope="module")
def learned():
    takes = [labelled(seed) for seed in range(8)]
    material = Material(takes[:4], takes[4:])
    quick = Schedule(layer=Stage(epochs=2), fine_tuning=Stage(3, 0.05, 0.9, 0.0))
    manifold = learn_manifold(
        [take.positions for take in material.training],
        quick,
        window=32,
        overlap=16,
        filters=(12, 16),
        taps=5,
        show_progress=False,
    )
    return manifold, material


def looks_like_a_picture(file: Path) -> bool:
    return file.read_bytes()[:4] in (b"\x89PNG", b"GIF8") and file.stat().st_size > 5000


def test_interpolation_of_press_ups_and_walks(learned, tmp_path):
    result = interpolation(*learned)
    press_ups, styles = result.pairs
    assert (press_ups.count, styles.count) == (3, 3)
    for pairs in result.pairs:
        assert pairs.rows[ENDS].bone_length < 0.5
        assert pairs.rows[LINEAR].bone_length > pairs.rows[ENDS].bone_length
    shown = result.shown
    one, other = list(shown.values())[:2]
    np.testing.assert_allclose(shown[LINEAR], (one + other) / 2)
    assert all(len(shown[name]) == len(one) for name in METHODS)
    claims = result.findings()
    assert ["press-ups" in claim.claim for claim in claims] == [True, False, True, False]
    for method, pair in ((ALONG, claims[:2]), (SHORTEST, claims[2:])):
        for claim, pairs in zip(pair, result.pairs, strict=True):
            assert claim.measured.startswith(f"{method} is better than")
            assert f"{pairs.rows[method].nearest_pose:.2f} against" in claim.measured
    assert result.text().count(ALONG) == result.text().count(SHORTEST) == 2
    result.save_picture(tmp_path / "a.png")
    assert looks_like_a_picture(tmp_path / "a.png")


def test_better_on_every_measure_is_what_held_means(learned):
    result = interpolation(*learned)
    pairs = result.pairs[0]
    assert pairs.better(LINEAR, LINEAR) == []
    assert {"bone length", "jitter", "nearest pose"} <= set(pairs.better(ENDS, LINEAR))
    claim = result.findings()[0]
    assert claim.held == (len(pairs.better(ALONG, LINEAR)) == 5)


def test_interpolation_needs_pairs(learned):
    manifold, material = learned
    with pytest.raises(ValueError, match="neither press-ups"):
        interpolation(manifold, Material(material.training, material.testing[:1]))


def test_sampling_measures_priors_beside_real_motion(learned, tmp_path):
    result = sampling(*learned)
    assert result.rows[REAL].bone_length < result.rows[UNIFORM].bone_length
    assert result.rows[UNIFORM].nearest_pose > result.rows[FITTED].nearest_pose
    uniform, fitted = result.findings()
    assert not uniform.held
    assert "fitted" in fitted.claim
    result.save_picture(tmp_path / "a.png")
    result.save_gif(tmp_path / "a.gif")
    assert looks_like_a_picture(tmp_path / "a.png")
    assert looks_like_a_picture(tmp_path / "a.gif")


def test_a_take_in_one_piece_is_the_whole_take(learned, tmp_path):
    manifold, material = learned
    result = lengths(manifold, material)
    # Takes of 120 frames: 160 and 320 do not cut them.
    for pieces in ("160 frames", "320 frames"):
        assert result.row(pieces).error == pytest.approx(result.row(WHOLE).error)
        assert np.isnan(result.row(pieces).seam)
    assert result.row("40 frames").seam > 0
    assert result.frames == sum(len(take.positions) for take in material.testing)
    assert result.findings()[0].held
    result.save_picture(tmp_path / "a.png")
    assert looks_like_a_picture(tmp_path / "a.png")
