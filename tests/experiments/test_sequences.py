"""The experiments of jang2018 on tiny networks: that they measure what they say."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.experiments.sequences.actions import Action, read_action, synthetic_action
from numpy_cae.experiments.sequences.figure_2 import Figure2, figure_2
from numpy_cae.experiments.sequences.figure_3 import FITTED, PRIOR, REAL, figure_3, fitted_latents
from numpy_cae.experiments.sequences.regulariser import _whitened, regulariser
from numpy_cae.experiments.sequences.long_takes import BLENDED, GLUED, long_takes
from numpy_cae.experiments.sequences.reconstruction import (
    HELD,
    LINEAR,
    MEAN,
    NETWORK,
    reconstruction,
)
from numpy_cae.experiments.sequences.samples import samples
from numpy_cae.experiments.sequences.study import (
    Curve,
    between_draws_of_the_prior,
    discrepancy,
    study,
)
from numpy_cae.experiments.sequences.uses import uses
from numpy_cae.experiments.sequences.teacher_forcing import TeacherForced, teacher_forcing
from numpy_cae.measures import angle_distance
from numpy_cae.motion import angles_of
from numpy_cae.training import SequenceSchedule
from numpy_cae.verify import check_gradients

SHORT = SequenceSchedule(epochs=1, steps=4, batch=8, directions=4)
SIZES = {"hidden": 8, "latent": 4, "show_progress": False}


@pytest.fixture(scope="module")
def studies():
    found = []
    for kind in ("walking", "waiting"):
        takes = [angles_of(make_take(kind, seed, 4.0, 25.0).motion) for seed in range(4)]
        styles = ("neutral", "tired", "brisk", "old") if kind == "walking" else ()
        action = Action(kind, takes[:2], takes[2:], kind == "walking", styles)
        found.append(study(action, SHORT, **SIZES))
    return found


def test_a_study_measures_before_the_first_step_and_after(studies):
    curve = studies[0].curve
    assert list(curve.steps) == [0, 1, 2, 3, 4]
    assert np.isfinite(curve.error).all() and (curve.discrepancy > 0).all()
    x = studies[0].drawn(1000, 7, training=False)
    manifold = studies[0].manifold
    error = angle_distance(
        manifold.denormalise(manifold.network.denoise(x)), manifold.denormalise(x)
    )
    assert curve.error[-1] == pytest.approx(error, rel=0.03)


def test_the_discrepancy_of_the_prior_itself_is_the_floor():
    rng = np.random.default_rng(0)
    floor = between_draws_of_the_prior(4)
    assert discrepancy(rng.standard_normal((1000, 4)), rng) == pytest.approx(floor, rel=0.6)
    assert discrepancy(1 + rng.standard_normal((1000, 4)), rng) > 20 * floor


def test_figure_2_weighs_first_and_last_tenth(tmp_path):
    falling = Curve(np.arange(20), np.linspace(2, 0.2, 20), np.geomspace(1, 0.01, 20))
    still = replace(falling, error=np.ones(20))
    figure = Figure2({"walking": falling})
    assert figure.ends("walking", "error") == pytest.approx(
        (np.mean(falling.error[:2]), np.mean(falling.error[-2:]))
    )
    assert all(finding.held for finding in figure.findings())
    held = [f.held for f in Figure2({"walking": falling, "waiting": still}).findings()]
    assert held == [False, True]
    figure.save_picture(tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 1000
    assert "walking" in figure.text()


def test_figure_3_samples_sixteen_from_each(studies, tmp_path):
    figure = figure_3(studies[0])
    for source in (FITTED, PRIOR, REAL):
        assert figure.positions[source].shape == (16, 50, 20, 3)
    figure.save_picture(tmp_path / "samples.png")
    figure.save_gif(tmp_path / "samples.gif", PRIOR, count=1)
    z = fitted_latents(studies[0], 4000, 0)
    seen = studies[0].manifold.network.encode(studies[0].drawn(1000, 0))
    assert np.allclose(np.cov(z, rowvar=False), np.cov(seen, rowvar=False), atol=0.05)


def test_reconstruction_beside_simpler_ones(studies):
    table = reconstruction(studies[:1])
    x = studies[0].held_out()
    assert table.row("walking", MEAN).squared == pytest.approx(np.mean(x.astype(float) ** 2))
    held = np.mean((x - x[:, :1]).astype(float) ** 2)
    assert table.row("walking", HELD).squared == pytest.approx(held, rel=1e-5)
    assert table.row("walking", LINEAR).squared < table.row("walking", MEAN).squared
    (finding,) = table.findings()
    assert finding.held == (
        table.row("walking", NETWORK).squared < table.row("walking", LINEAR).squared
    )


def test_real_clips_are_at_the_measure_of_samples(studies):
    table = samples(studies, count=20)
    for action in ("walking", "waiting"):
        assert table.row(action, REAL).near == pytest.approx(1)
    assert 0.5 < table.row("walking", REAL).stride < 2
    assert np.isnan(table.row("waiting", FITTED).stride)
    assert len(table.findings()) == 3 and "told apart" in table.text()


def test_the_regulariser_with_and_without(studies):
    free = [study(each.action, replace(SHORT, weight=0.0), **SIZES) for each in studies[:1]]
    table = regulariser(studies[:1], free)
    assert table.rows[0].error_without == pytest.approx(
        np.mean((free[0].manifold.network.denoise(free[0].held_out()) - free[0].held_out()) ** 2)
    )
    assert len(table.findings()) == 3 and "walking" in table.text()
    z = np.random.default_rng(0).normal(3, 2, (500, 3)) @ np.random.default_rng(1).normal(
        size=(3, 3)
    )
    assert np.allclose(np.cov(_whitened(z, z), rowvar=False), np.eye(3))


def test_teacher_forcing_is_trained_by_its_own_gradient_and_measured_self_fed(studies):
    model = TeacherForced(5, 4, 3, np.random.default_rng(0), np.float64)
    rng = np.random.default_rng(1)
    x, prior = rng.normal(size=(3, 6, 5)), rng.normal(size=(3, 3))
    directions = np.eye(3)

    def loss(weight_u):
        model.weights["decoder_u"] = weight_u
        losses, gradients = model.loss_and_gradients(x, prior, directions, 0.3)
        return np.float64(losses.total), lambda dy=1.0: dy * gradients["decoder_u"]

    check_gradients(loss, model.weights["decoder_u"].copy())
    forced = study(studies[0].action, SHORT, network=TeacherForced, **SIZES)
    table = teacher_forcing(studies[0], forced)
    assert table.findings()[0].held == (table.self_fed < table.teacher_forced)


def test_denoising_interpolation_and_analogy(studies, tmp_path, monkeypatch):
    for name, fewer in (("uses.ANALOGIES", 2), ("uses.PAIRS", 10), ("reconstruction.SEEN", 300)):
        monkeypatch.setattr(f"numpy_cae.experiments.sequences.{name}", fewer)
    found = uses(studies[0])
    for sigma, errors in found.denoised.items():
        assert errors["doing nothing"] == pytest.approx(sigma**2, rel=0.1)
        assert errors["low-pass"] < errors["doing nothing"]
    assert found.between["real training clips"] == 1
    assert min(found.between.values()) > 0
    assert 0.1 < found.chance < 0.3 and set(found.analogies) >= {"c itself"}
    denoises, between, analogy = found.findings()
    assert not denoises.held  # four steps of training
    assert between.held == (found.between["the network"] < found.between["straight line of clips"])
    assert "walking" in analogy.claim and "tired" in found.text()
    found.save_picture(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_whole_takes_have_no_seam_where_clips_are_blended():
    takes = [angles_of(make_take("walking", seed, 7.0, 25.0).motion) for seed in range(2)]
    result = long_takes(study(Action("walking", takes[:1], takes[1:]), SHORT, **SIZES))
    glued, blended = (result.rows[name] for name in (GLUED, BLENDED))
    assert glued.seam > 3 > blended.seam
    assert result.findings()[0].held == (blended.seam <= 1.1)
    assert "glued" in result.text()


def test_actions_are_split_by_people_or_by_pattern(data_folder):
    made = synthetic_action("walking", 0.2, 0.1)
    assert made.periodic and len(made.training) and len(made.testing)
    with pytest.raises(ValueError, match="no action 'flying'"):
        synthetic_action("flying")
    read = read_action("walking", [data_folder / "cmu/expmap/walking"], ["walking_5.txt"])
    assert (len(read.training), len(read.testing)) == (4, 1)


def test_the_figure_is_made_of_studies(studies):
    assert set(figure_2(studies).curves) == {"walking", "waiting"}
