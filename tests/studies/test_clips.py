"""Windows, the errors measured against them, and their split."""

import numpy as np
import pytest

from numpy_cae.evaluation.clips import clips_of
from numpy_cae.manifold.shifted_projection import project_shifted
from studies.filling_in import project_repeated


@pytest.fixture(scope="module")
def clips(small_manifold, labelled):
    return clips_of(small_manifold, [take.positions for take in labelled.testing])


def test_the_error_is_in_centimetres(small_manifold, clips, labelled):
    assert clips.error(clips.x) == 0
    off = clips.x.copy()
    off[..., 21:24] += 0.01 * small_manifold.scale[21:24].astype(np.float32)
    assert clips.error(off, "left_wrist") == pytest.approx(1.0, rel=1e-3)
    assert clips.error(off) == pytest.approx(np.sqrt(1 / 20), rel=1e-3)
    assert clips.real.all() and len(np.unique(clips.take)) == len(labelled.testing)


def test_ends_repeated_equals_the_manifold_projection(small_manifold, clips):
    whole = small_manifold.project(small_manifold.denormalise(clips.x[0]))
    ours = project_repeated(small_manifold, clips.x[:1])
    np.testing.assert_allclose(small_manifold.denormalise(ours)[0], whole, atol=1e-5)
    held = small_manifold.padded(clips.x)
    assert held.shape[1] % small_manifold.stride == 0
    np.testing.assert_array_equal(held[:, 0], clips.x[:, 0])
    assert not np.allclose(project_shifted(small_manifold.network, clips.x[:1]), ours)
