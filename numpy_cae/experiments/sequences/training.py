"""What jang2018 says of its training: with λ > 0 and λ = 0, self-fed and teacher-forced.

λ = 0 against λ > 0: does the regulariser match the prior, and what does it cost? Under teacher
forcing, the alternative to the paper's "sampling-based method", the decoder's next input is the
true frame instead of its own. Both networks are measured fed with their own frames.
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae import ops
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.experiments.sequences.study import (
    CLIPS,
    REPEATS,
    Study,
    discrepancy,
    prior_discrepancy,
)
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.models.sequential_autoencoder import Losses, Weights, gru_weights

MAX_ERROR_RATIO, MAX_DISCREPANCY_RATIO = 1.15, 2.0
"""Bounds of the claims: relative to λ = 0, and to the discrepancy of two draws of the prior."""


def regulariser(with_it: Sequence[Study], without: Sequence[Study], seed: int = 0) -> Result:
    """Compare studies of the same actions, trained from one seed with λ above 0 and with λ = 0.

    The seed chooses the clips and draws of the discrepancies.
    """
    manifold = with_it[0].manifold
    smallest = prior_discrepancy(manifold.network.latent, seed)
    rows = []
    for regularised, free in zip(with_it, without, strict=True):
        errors = regularised.squared_error(), free.squared_error()
        distances = _mean_discrepancy(regularised, seed), _mean_discrepancy(free, seed)
        rows.append([regularised.action.name, *errors, *distances, smallest])
    name = f"λ = {manifold.settings['schedule']['weight']:g}"
    header = [name, "mean square", "λ = 0", "to the prior", "λ = 0", "draws of the prior"]
    table = Table("", header, rows, ("", ".3f", ".3f", ".4f", ".4f", ".4f"))
    title = "The Wasserstein regulariser of jang2018: with and without"
    return Result(title, [table], _claims(rows))


def _claims(rows: Sequence[Sequence]) -> list[Claim]:
    cost = {name: error / free for name, error, free, *_ in rows}
    closeness = {name: z / smallest for name, _, _, z, _, smallest in rows}
    costs, distances = (
        ", ".join(f"{name} {ratio:.{digits}f}" for name, ratio in ratios.items())
        for ratios, digits in ((cost, 2), (closeness, 1))
    )
    return [
        Claim(
            "The regulariser forces the latent vectors to match the prior (jang2018; here: "
            "within twice the distance between two draws of the prior).",
            all(ratio <= MAX_DISCREPANCY_RATIO for ratio in closeness.values()),
            f"{distances} times that distance.",
        ),
        Claim(
            'The regulariser "promotes better reconstruction" (jang2018).',
            all(ratio < 1 for ratio in cost.values()),
            f"Error relative to λ = 0: {costs}.",
        ),
        Claim(
            "The regulariser increases the reconstruction error by at most 15%.",
            all(ratio <= MAX_ERROR_RATIO for ratio in cost.values()),
            f"Error relative to λ = 0: {costs}.",
        ),
    ]


def _mean_discrepancy(study: Study, seed: int) -> float:
    """Of `REPEATS` draws of held-out clips."""
    rng = np.random.default_rng(seed)
    draws = [study.random_clips(CLIPS, seed + n, training=False) for n in range(REPEATS)]
    return float(np.mean([discrepancy(study.manifold.network.encode(x), rng) for x in draws]))


class TeacherForced(SequentialAutoencoder):
    """The same network whose loss feeds the decoder the true frames; without a burn-in, which has
    no true frames."""

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """As the parent's, but the decoder's inputs are 0, x_T, …, x_2."""
        weights = self.weights
        z, encode_back = self.encode_with_pullback(x)
        first, state_back = ops.linear(z, weights["state_w"], weights["state_b"])
        target = x[:, ::-1]  # the decoder writes the last frame first
        inputs = np.concatenate([np.zeros_like(x[:, :1]), target[:, :-1]], axis=1)
        states, gru_back = ops.gru(inputs, first, *gru_weights(weights, "decoder"))
        frames, frame_back = ops.linear(states, weights["frame_w"], weights["frame_b"])
        error, error_back = ops.mean_squared_error(frames, target)
        distance, distance_back = ops.sliced_wasserstein(z, prior, directions)

        d_states, frame_w, frame_b = frame_back(error_back())
        _, d_first, *of_gru = gru_back(d_states)
        dz, state_w, state_b = state_back(d_first)
        gradients = encode_back(dz + distance_back(weight))
        gradients |= {f"decoder_{n}": d for n, d in zip("wubc", of_gru, strict=True)}
        gradients |= {"state_w": state_w, "state_b": state_b}
        gradients |= {"frame_w": frame_w, "frame_b": frame_b}
        losses = Losses(float(error + weight * distance), float(error), float(distance))
        return losses, {name: gradients[name] for name in weights}


def teacher_forcing(self_fed: Study, forced: Study) -> Result:
    """Compare two studies of one action; the second was trained with `network=TeacherForced`."""
    action = self_fed.action.name
    own, given = self_fed.squared_error(), forced.squared_error()
    rows = [["self-fed", own], ["teacher-forced", given]]
    claim = Claim(
        "A decoder that is fed its own frames should be trained so (MBR17, jang2018).",
        own < given,
        f"{action}: {own:.3f} of unit variance trained self-fed, {given:.3f} teacher-forced.",
    )
    table = Table("", [f"{action}, trained", "mean square, standardised"], rows, ".3f")
    return Result("Self-fed against teacher-forced training", [table], [claim])
