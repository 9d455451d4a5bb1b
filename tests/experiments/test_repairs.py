"""Repair and filling in: each table's rows are what they say, and findings follow from them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from numpy_cae.experiments.clips import (
    ALL_SHIFTS,
    ENDS_HELD,
    NETWORK,
    clips_of,
    project_ends_held,
)
from numpy_cae.experiments.repair.kinect import SEEN, kinect
from numpy_cae.experiments.repair.kinect import TRUE as KINECT_TRUTH
from numpy_cae.experiments.repair.missing_marker import MEAN_POSE, TOLD, missing_marker
from numpy_cae.experiments.repair.repair_sweep import (
    CORRUPTED_ROW,
    INTERPOLATED,
    LINEAR,
    PS,
    RESCALED,
    RepairSweep,
    repair_sweep,
)
from numpy_cae.experiments.repair.stepped_keyframes import CUBIC, HELD, TRUE, stepped_keyframes
from numpy_cae.experiments.repair.stepped_keyframes import LINEAR as LINEAR_KEYS
from numpy_cae.experiments.repair.two_unpoolings import EVEN, RANDOM, two_unpoolings
from numpy_cae.motion import JOINTS


@pytest.fixture(scope="module")
def sweep(small_manifold, labelled):
    return repair_sweep(small_manifold, labelled)


def drawn(file: Path) -> bool:
    return file.read_bytes()[:4] in (b"\x89PNG", b"GIF8") and file.stat().st_size > 5000


def test_the_corrupted_row_grows_as_the_root_of_p(sweep):
    corrupted = sweep.blind[CORRUPTED_ROW]
    np.testing.assert_allclose(corrupted / np.sqrt(PS), corrupted[4] / np.sqrt(0.5), rtol=0.1)


def test_who_is_told_of_few_holes_is_nearly_right_and_beats_everyone(sweep):
    assert sweep.told[INTERPOLATED][0] < min(errors[0] for errors in sweep.blind.values())
    assert all(len(errors) == len(PS) for errors in [*sweep.blind.values(), *sweep.told.values()])


def test_a_single_source_has_the_column_of_the_whole(sweep):
    for name, errors in sweep.blind.items():
        assert sweep.half["bandai"][name] == pytest.approx(errors[PS.index(0.5)])
    assert "by source" not in sweep.text()
    two = replace(sweep, half={"one": sweep.half["bandai"], "other": sweep.half["bandai"]})
    assert "by source" in two.text() and "| one | other |" in " ".join(two.text().split())


def test_the_linear_denoiser_beats_filters_which_are_linear_too(sweep):
    for name, errors in sweep.blind.items():
        if name.startswith("Savitzky"):
            assert np.all(np.array(sweep.blind[LINEAR]) < errors)


def test_the_winner_of_the_sweep_is_named_and_findings_follow():
    rows = {
        CORRUPTED_ROW: [9.0] * 9,
        "PCA on frames": [3.0] * 9,
        NETWORK: [1.0] * 3 + [4.0] * 6,
        NETWORK + RESCALED: [5.0] * 9,
        ENDS_HELD: [5.0] * 9,
        ENDS_HELD + RESCALED: [5.0] * 9,
        ALL_SHIFTS: [5.0] * 9,
        ALL_SHIFTS + RESCALED: [5.0] * 9,
        LINEAR: [2.0] * 9,
    }
    table = RepairSweep(rows, {INTERPOLATED: [1.0] * 9}, {}, 1.5, "", {})
    assert f"{NETWORK} at p = 0.1 to 0.3; {LINEAR} at p = 0.4 to 0.9." in table.text()
    assert [finding.held for finding in table.findings()] == [True, False, False]
    rows[NETWORK][4] = 1.9
    assert [finding.held for finding in table.findings()] == [True, True, True]
    rows[NETWORK][4] = 4.6
    assert not table.findings()[0].held
    rows[NETWORK + RESCALED][4] = 4.4
    assert not table.findings()[0].held
    assert replace(table, taught_rescaled=True).findings()[0].held


def test_the_sweep_draws_its_picture(sweep, tmp_path):
    sweep.save_picture(tmp_path / "a.png")
    assert drawn(tmp_path / "a.png")


def test_a_kinect_is_noisier_than_the_truth_and_filters_calm_it(small_manifold, labelled, tmp_path):
    result = kinect(small_manifold, labelled)
    table = result.tables["bandai"]
    assert table[KINECT_TRUTH][0] == 0
    assert table[SEEN][1] > 3 * table[KINECT_TRUTH][1]
    assert table["median filter"][1] < table[SEEN][1]
    assert 1 < table[SEEN][0] < 20
    first = result.findings()[0]
    assert first.held == (table[ALL_SHIFTS][0] < table[SEEN][0] * 2 / 3)
    result.save_picture(tmp_path / "a.png")
    assert drawn(tmp_path / "a.png")


def test_a_missing_marker_is_looked_for_at_its_joint(small_manifold, labelled, tmp_path):
    result = missing_marker(small_manifold, labelled)
    assert list(result.errors) == list(JOINTS)
    # Bones are of fixed length, so what is told which joint is missing knows the spine.
    assert result.errors["spine"][TOLD] < 0.2 * result.errors["spine"][MEAN_POSE]
    assert result.over(("spine",), TOLD) == pytest.approx(result.errors["spine"][TOLD])
    assert result.text().count("\n| ") == 1 + len(JOINTS) + 1  # header, joints, all
    wrist = result.findings()[0]
    assert result.errors["left_wrist"][NETWORK] == pytest.approx(_wrist(small_manifold, labelled))
    assert f"{result.over(('left_wrist', 'right_wrist'), MEAN_POSE):.2f}" in wrist.measured
    result.save_picture(tmp_path / "a.png")
    assert drawn(tmp_path / "a.png")


def _wrist(manifold, labelled):
    """By hand: the wrist zeroed, the whole window projected, looked up."""
    clips = clips_of(manifold, [take.positions for take in labelled.testing])
    lost = clips.x.copy()
    lost[..., 21:24] = 0
    return clips.error(project_ends_held(manifold, lost), "left_wrist")


def test_stepped_keyframes_are_late_and_rough(small_manifold, labelled, tmp_path):
    result = stepped_keyframes(small_manifold, labelled)
    held, truth, cubic = (result.rows[name] for name in (HELD, TRUE, CUBIC))
    assert truth.error == 0
    assert held.late < held.error
    assert truth.late > 0
    assert held.jitter > 1.5 * truth.jitter
    assert cubic.jitter < held.jitter
    told = [line for line in result.text().splitlines() if " yes |" in line]
    assert len(told) == 4 and LINEAR_KEYS in told[0]
    result.save_picture(tmp_path / "a.png")
    result.save_gif(tmp_path / "a.gif")
    assert drawn(tmp_path / "a.png") and drawn(tmp_path / "a.gif")


def test_random_unpooling_is_the_noisier(small_manifold, labelled, tmp_path):
    result = two_unpoolings(small_manifold, labelled)
    assert result.rows[RANDOM][1] > 2 * result.rows[EVEN][1]
    assert result.rows[RANDOM] == two_unpoolings(small_manifold, labelled).rows[RANDOM]
    assert result.rows[RANDOM] != two_unpoolings(small_manifold, labelled, seed=1).rows[RANDOM]
    result.save_picture(tmp_path / "a.png")
    assert drawn(tmp_path / "a.png")
