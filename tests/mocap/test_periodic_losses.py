"""Frames that are lost at regular distances."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.mocap import load_motion, write_bvh


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("frames", [240, 1200])
def test_every_second_frame_may_be_lost(first, frames, tmp_path):
    path = tmp_path / "walk.bvh"
    write_bvh(make_take("walk", 0, seconds=frames / 120, rate=120.0).motion, path)
    lines = path.read_text().splitlines()
    begin = len(lines) - frames
    for frame in range(first, frames, 2):
        lines[begin + frame] = " ".join(["nan"] * len(lines[begin + frame].split()))
    path.write_text("\n".join(lines) + "\n")
    motion = load_motion(path)
    assert len(motion) == frames
    assert np.isfinite(motion.rotations[1 - first :: 2]).all()
