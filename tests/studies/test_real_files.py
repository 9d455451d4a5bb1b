"""The measures of real files: jumps that are put into a walk are counted and repaired."""

import numpy as np

from data_synth import make_take
from numpy_cae.mocap import write_bvh
from studies import real_files as real
from studies.shared.damages import twisted_limb


def test_a_damaged_a_clean_and_a_broken_file(tmp_path, small_manifold):
    walk = make_take("walk", 2, seconds=3.0, rate=30.0).motion
    write_bvh(walk, tmp_path / "clean.bvh", unit=0.01)
    twisted = twisted_limb(walk, np.random.default_rng(1))[0]
    write_bvh(twisted, tmp_path / "twisted.bvh", unit=0.01)
    (tmp_path / "wrong.bvh").write_text("HIERARCHY\nROOT\n")
    result = real.run(small_manifold, [tmp_path])
    (table,) = result.tables
    assert table.rows[-1][0] == "wrong.bvh" and "refused" in table.rows[-1][-1]
    assert table.value("twisted.bvh: as it is", real.JUMPS) == 2
    assert table.value("twisted.bvh: repair", real.JUMPS) == 0
    assert table.value("twisted.bvh: ten lines", real.JUMPS) > 0
    assert table.value("twisted.bvh: repair", "said").endswith("proposed: helped")
    assert table.value("clean.bvh: repair", real.CHANGE) == 0
    assert "1 refused and 1 damaged, of these 1 helped, 0 harmed" in result.claims[-1].figures
    assert result.claims[-1].confirmed
    before = dict.fromkeys(real.HEADER, 4.0)
    assert real.verdict(before, before | {real.NEW: 0}) == "as before"
    assert real.verdict(before, before | {real.NEW: 0, real.FEET: 5.0}) == "harmed"
