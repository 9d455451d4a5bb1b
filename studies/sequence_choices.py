"""What jang2018's choices contribute: the reversed target, and the guess that is fed back.

    python -m studies sequence_choices

"The target motion sequence is set in a reversed order from the source motion sequence": beside it a
network whose encoder reads in the order in which its decoder writes. "Decoder's guess is used as
next input": beside it a decoder without input, and one that is given the true frames in training
and its own ones afterwards. Small networks, held-out clips of synthetic people, the same weights at
the start and the same clips for all.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from numpy_cae import ops
from numpy_cae.fast import FastSequentialAutoencoder
from numpy_cae.manifold import learn_sequences
from numpy_cae.models.sequential_autoencoder import Losses, Weights, gru_weights, name_gradients
from numpy_cae.ops.shapes import Pullback
from numpy_cae.training import SEQUENCE_RECIPES, train_sequential
from studies.jang2018.actions import ACTIONS, Action, synthetic_action
from studies.jang2018.training import Study
from studies.shared.judging import agreed, all_of
from studies.shared.messages import note
from studies.shared.result import Claim, Result, Table
from studies.shared.small_networks import mean_and_range

MINUTES = 8.0
"""Of each action to train on, and as many to test on."""
HIDDEN = 64
STEPS = 400
SEEDS = 3
AS_PAPER = "as the paper"
SAME_ORDER = "target in the order of the source"
NO_INPUT = "no input of the decoder"
TRUE_FRAMES = "true frames as input in training"


def run(
    seed: int = 0,
    seeds: int = SEEDS,
    steps: int = STEPS,
    minutes: float = MINUTES,
    names: tuple[str, ...] = ACTIONS,
) -> Result:
    """Train each network on each action, and measure it on held-out clips."""
    actions = [synthetic_action(kind, minutes, seed) for kind in names]
    engines = {
        AS_PAPER: FastSequentialAutoencoder,
        SAME_ORDER: SameOrder,
        NO_INPUT: NoInput,
        TRUE_FRAMES: TrueFrames,
    }
    errors: dict[str, dict[str, list[float]]] = {}
    for name, engine in engines.items():
        errors[name] = {}
        for action in actions:
            note(f"{action.name}, {name}")
            of_seeds = [
                _error(engine, action, number, steps) for number in range(seed, seed + seeds)
            ]
            errors[name][action.name] = of_seeds
    rows = []
    for name, of_actions in errors.items():
        rows.append([name, *(mean_and_range(of_seeds) for of_seeds in of_actions.values())])
    caption = f"Mean squared error of held-out clips, standardised, {seeds} seeds:"
    table = Table(caption, ["network", *names], rows)
    claims = [
        _claim("target_reversed", errors, [SAME_ORDER]),
        _claim("guess_fed_back", errors, [NO_INPUT, TRUE_FRAMES]),
    ]
    return Result("Choices of the sequential network", [table], claims)


def _error(engine: Callable[..., Any], action: Action, seed: int, steps: int) -> float:
    """The error of a network of this engine on held-out clips."""
    schedule = replace(SEQUENCE_RECIPES["fast"], epochs=10, steps=max(1, steps // 10))
    rng = np.random.default_rng(seed)
    untrained = replace(schedule, epochs=0)
    manifold = learn_sequences(action.training, untrained, rng, hidden=HIDDEN, burn_in=0)
    manifold.network = engine(manifold.network)
    draw = partial(manifold.random_clips, action.training)
    train_sequential(manifold.network, draw, schedule, rng)
    return Study(action, manifold).squared_error()


def _claim(key: str, errors: dict[str, dict[str, list[float]]], opponents: Sequence[str]) -> Claim:
    """Whether the paper's network has a lower error in each action and with each seed."""
    below = {}
    for opponent in opponents:
        is_lower = []
        for action, of_seeds in errors[opponent].items():
            pairs = zip(errors[AS_PAPER][action], of_seeds, strict=True)
            is_lower += [ours < theirs for ours, theirs in pairs]
        below[opponent] = agreed(is_lower)
    figures = f"{_listed(errors[AS_PAPER])};"
    listed = "; ".join(f"{opponent}: {_listed(errors[opponent])}" for opponent in opponents)
    return Claim(key, all_of(*below.values()), figures, opponent=f"{listed}.")


def _listed(of_actions: dict[str, list[float]]) -> str:
    return ", ".join(f"{action} {np.mean(values):.3f}" for action, values in of_actions.items())


class SameOrder(FastSequentialAutoencoder):
    """The encoder reads the last frame first, as the decoder writes it."""

    def encode_with_pullback(self, x: np.ndarray) -> tuple[np.ndarray, Pullback]:
        """As `SequentialAutoencoder.encode_with_pullback`, of clips in reversed order."""
        return super().encode_with_pullback(x[:, ::-1])


class NoInput(FastSequentialAutoencoder):
    """The decoder's input has no weight, and does not get one."""

    def __init__(self, model: Any):
        super().__init__(model)
        self.weights["decoder_w"][...] = 0

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """As `SequentialAutoencoder.loss_and_gradients`, zero for the weights of the input."""
        losses, gradients = super().loss_and_gradients(x, prior, directions, weight)
        gradients["decoder_w"] = np.zeros_like(gradients["decoder_w"])
        return losses, gradients


class TrueFrames(FastSequentialAutoencoder):
    """In training the decoder is given the true frame before each, "teacher forcing"."""

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """As `SequentialAutoencoder.loss_and_gradients`, with true frames as input; without
        burn-in."""
        weights = self.weights
        target = x[:, ::-1]
        inputs = np.concatenate([np.zeros_like(target[:, :1]), target[:, :-1]], axis=1)
        z, encode_pullback = self.encode_with_pullback(x)
        h0, state_pullback = ops.linear(z, weights["state_w"], weights["state_b"])
        states, gru_pullback = ops.gru(inputs, h0, *gru_weights(weights, "decoder"))
        frames, frame_pullback = ops.linear(states, weights["frame_w"], weights["frame_b"])
        error, error_pullback = ops.mean_squared_error(frames, target)
        discrepancy, prior_pullback = ops.sliced_wasserstein(z, prior, directions)
        d_states, d_frame_w, d_frame_b = frame_pullback(error_pullback())
        _, dh0, *d_gru = gru_pullback(d_states)
        dz, d_state_w, d_state_b = state_pullback(dh0)
        gradients = encode_pullback(dz + prior_pullback(weight))
        gradients |= name_gradients("decoder", d_gru)
        gradients |= {"state_w": d_state_w, "state_b": d_state_b}
        gradients |= {"frame_w": d_frame_w, "frame_b": d_frame_b}
        total = float(error + weight * discrepancy)
        in_order = {name: gradients[name] for name in weights}
        return Losses(total, float(error), float(discrepancy)), in_order
