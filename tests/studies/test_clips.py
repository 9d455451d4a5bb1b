"""Windows, the errors measured against them, and their split."""

import numpy as np
import pytest

from numpy_cae.evaluation.tables import clips_of


def test_the_error_is_in_centimetres(small_manifold, labelled):
    clips = clips_of(small_manifold, [take.positions for take in labelled.testing])
    assert clips.error(clips.x) == 0
    off = clips.x.copy()
    off[..., 21:24] += 0.01 * small_manifold.scale[21:24].astype(np.float32)
    assert clips.error(off, "left_wrist") == pytest.approx(1.0, rel=1e-3)
    assert clips.error(off) == pytest.approx(np.sqrt(1 / 20), rel=1e-3)
    assert clips.real.all() and len(np.unique(clips.take)) == len(labelled.testing)
