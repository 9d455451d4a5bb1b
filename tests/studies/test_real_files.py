"""The measures of real files: jumps that are put into a walk are counted and repaired."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.mocap import write_bvh
from studies import real_files
from studies.shared.damages import twisted_limb


@pytest.fixture(scope="module")
def result(small_manifold, tmp_path_factory):
    """The result of a folder with a clean walk, a walk with a twisted leg and a broken file."""
    folder = tmp_path_factory.mktemp("files")
    walk = make_take("walk", 2, seconds=3.0, rate=30.0).motion
    twisted, _ = twisted_limb(walk, np.random.default_rng(1))
    write_bvh(walk, folder / "clean.bvh", unit=0.01)
    write_bvh(twisted, folder / "twisted.bvh", unit=0.01)
    (folder / "wrong.bvh").write_text("HIERARCHY\nROOT\n")
    return real_files.run(small_manifold, [folder])


def test_a_file_that_cannot_be_read_is_a_row(result):
    *_, last = result.tables[0].rows
    assert last[0] == "wrong.bvh" and "refused" in last[-1]


@pytest.mark.parametrize(("method", "jumps"), [(real_files.BEFORE, 2), (real_files.REPAIR, 0)])
def test_jumps_are_counted_before_and_after_repair(result, method, jumps):
    assert result.tables[0].value(f"twisted.bvh: {method}", real_files.JUMPS) == jumps


def test_the_simple_filter_leaves_a_jump(result):
    row = f"twisted.bvh: {real_files.FILTER}"
    assert result.tables[0].value(row, real_files.JUMPS) > 0


def test_the_proposed_repair_has_its_verdict(result):
    assert result.tables[0].value("twisted.bvh: repair", "said").endswith("proposed: helped")


def test_a_clean_file_is_not_changed(result):
    assert result.tables[0].value("clean.bvh: repair", real_files.CHANGE) == 0


def test_the_claim_counts_the_files(result):
    claim = result.claims[-1]
    assert claim.fulfilled
    assert "1 refused and 1 damaged, of these 1 helped, 0 harmed" in claim.figures


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, "as before"),
        ({real_files.JUMPS: 2.0}, "helped"),
        ({real_files.FEET: 5.0}, "harmed"),
        ({real_files.NEW: 1.0}, "harmed"),
    ],
)
def test_the_verdict_follows_the_rule(changes, expected):
    before = dict.fromkeys(real_files.HEADER, 4.0)
    after = before | {real_files.NEW: 0.0} | changes
    assert real_files.verdict(before, after) == expected
