"""The table of half zeroed values: each row is what it says."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.experiments import figure_1, half_zeroed
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import learn_manifold
from numpy_cae.motion import PARENTS, body_of
from numpy_cae.training import Schedule, Stage


@pytest.fixture(scope="module")
def measured():
    takes = [body_of(make_take("walk", s, seconds=3.0, rate=30.0).motion) for s in range(8)]
    quick = Schedule(layer=Stage(epochs=3), fine_tuning=Stage(4, 0.05, 0.9, 0.0))
    manifold = learn_manifold(
        takes[:6], quick, window=32, overlap=16, filters=(16, 24), taps=5, show_progress=False
    )
    return manifold, takes, half_zeroed(manifold, takes[:6], takes[6:])


def test_the_rows_that_need_no_network_are_what_they_must_be(measured):
    _, _, table = measured
    nothing, mean = table.row("doing nothing"), table.row("the mean pose")
    assert nothing.reconstruction == 0
    assert mean.reconstruction == mean.repair
    # Half of all values lost, at random: half of the mean pose's squared error is left.
    assert nothing.repair == pytest.approx(mean.repair * np.sqrt(0.5), rel=0.05)


def test_pca_never_does_worse_than_the_mean_pose_and_keeps_frames_exactly(measured):
    _, _, table = measured
    frames, windows = table.row("PCA on frames"), table.row("PCA on windows")
    assert frames.reconstruction == pytest.approx(0, abs=1e-4)
    for row in (frames, windows):
        assert row.repair < table.row("the mean pose").repair


def test_the_text_names_every_row(measured):
    _, _, table = measured
    text = table.text()
    for row in table.rows:
        assert f"| {row.method} " in text
        assert f"{row.repair:.2f}" in text


def test_figure_1_shows_one_clip_three_times(measured, tmp_path):
    manifold, takes, _ = measured
    figure = figure_1(manifold, takes[7])
    assert figure.corrupted.shape == figure.projected.shape == figure.truth.shape
    assert figure.error("truth") == 0
    assert figure.error("projected") != figure.error("corrupted") > 0
    truth = figure.positions("truth")
    bones = truth[:, 1:] - truth[:, list(PARENTS[1:])]
    np.testing.assert_allclose(
        np.linalg.norm(bones, axis=-1).mean(axis=0), manifold.lengths[1:], atol=1e-9
    )
    figure.save_picture(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_a_table_lines_its_columns_up():
    lines = text_table(["a", "number"], [["long name", "1.0"], ["b", "10.25"]]).splitlines()
    assert len({len(line) for line in lines}) == 1
    assert lines[1].endswith(":|")
    assert lines[2] == "| long name |    1.0 |"
