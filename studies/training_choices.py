"""What holden2015's choices of training contribute: fine tuning, random unpooling, sparsity and its
α, and the maximum in pooling.

    python -m studies training_choices --data bandai --test '*_005.bvh'

Networks of half of the filters learn by the paper's schedule with fewer epochs, three seeds each. α
is the weight of a mean here and of a norm, a sum, in the paper: with N values of the input and
N_Y hidden units our α is the paper's times N_Y / N. For layer 1, of 160 x 63 values and 80 x 64
units, the paper's 0.01 is 0.0051 here, and our 0.01 is its 0.0197; for layers 2 and 3 both are the
same.

Section 6 says of the sparsity term that "independent local features are learned": the correlation
of two units of layer 1, and the joints and frames of a filter's response (`representation`), are
measured before fine tuning, in which α is 0, and after it.

Pooling is compared in networks of one layer by the plain definitions, one of which has the mean of
each pair of frames instead of the maximum.
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from numpy_cae import ops
from numpy_cae.manifold import MotionManifold
from numpy_cae.models import ConvAutoencoder, ConvLayer
from numpy_cae.models.conv_layer import Pullback
from numpy_cae.training import Schedule, recipe
from studies.representation import correlation_of, count_columns, energy_of_responses
from studies.shared.judging import agreed, all_of, seeds_below
from studies.shared.material import Material
from studies.shared.result import Claim, Result, Table
from studies.shared.small_networks import (
    EPOCHS,
    FILTERS,
    SEEDS,
    UNTRAINED,
    Errors,
    EvenlyUnpooled,
    SmallNetworks,
    mean_and_range,
)
from studies.shared.trained import Trainer

ACTIVE = 0.1
"""A hidden unit is active where its magnitude is larger."""
ALPHA_OF_NORMS = 0.01 * (80 * 64) / (160 * 63)
"""The paper's α = 0.01 of norms as that of means, for layer 1."""
SAME = 0.02
"""It does not matter which α is taken if errors differ by at most this share."""
AS_PAPER = "as the paper"
LAYERS_ALONE = "no fine tuning"
LAYERS_LONGER = "no fine tuning, layers trained for twice as many epochs"
EVEN = "layers trained with even unpooling"
SPARSE = "α of the paper's norms, 0.0051"
FREE = "α = 0"
FREE_ALONE = "α = 0, no fine tuning"
STAGES = {
    "layers alone": (LAYERS_ALONE, FREE_ALONE),
    "after fine tuning": (AS_PAPER, FREE),
}
"""Stage to the trainings with and without the sparsity term."""


def run(
    material: Material,
    seed: int = 0,
    trainer: Trainer | None = None,
    epochs: int = EPOCHS,
    seeds: int = SEEDS,
) -> Result:
    """Train the networks on the training takes, and measure them on the test takes."""
    networks = SmallNetworks.of(material, trainer, seed, seeds)
    schedule = shortened(recipe("paper"), epochs)
    alone = replace(schedule, fine_tuning=replace(schedule.fine_tuning, epochs=0))
    manifolds = {
        AS_PAPER: networks.learn(schedule),
        LAYERS_ALONE: networks.learn(alone),
        LAYERS_LONGER: networks.learn(with_layer_epochs(alone, 2 * epochs)),
        EVEN: networks.learn_with(EVEN, EvenlyUnpooled, schedule),
        SPARSE: networks.learn(with_alpha(schedule, ALPHA_OF_NORMS)),
        FREE: networks.learn(with_alpha(schedule, 0.0)),
        FREE_ALONE: networks.learn(with_alpha(alone, 0.0)),
    }
    errors = {name: networks.errors(of_seeds) for name, of_seeds in manifolds.items()}
    active = {name: _active(networks, of_seeds) for name, of_seeds in manifolds.items()}
    rows = []
    for name, of_seeds in errors.items():
        columns = [mean_and_range(column) for column in zip(*of_seeds, strict=True)]
        rows.append([name, *columns, mean_and_range(active[name])])
    caption = f"{epochs} epochs of each stage, mean of {seeds} seeds ± half of the range:"
    table = Table(caption, ["training", *Errors.HEADER, "active units"], rows)
    pooling, correlations = _compare_pooling(networks, schedule)
    features, claims_of_features = _compare_features(networks, manifolds)
    claims = [
        _claim("fine_tuning", errors, LAYERS_ALONE, LAYERS_LONGER),
        _claim("random_trains", errors, EVEN),
        *_claims_of_sparsity(active),
        *claims_of_features,
        _claim_of_alpha(errors),
        correlations,
    ]
    return Result("Choices of training", [table, features, pooling], claims)


def shortened(schedule: Schedule, epochs: int) -> Schedule:
    """The schedule with so many epochs in each stage that has any."""
    layer = schedule.layer
    if layer.epochs:
        layer = replace(layer, epochs=epochs)
    return replace(schedule, layer=layer, fine_tuning=replace(schedule.fine_tuning, epochs=epochs))


def with_layer_epochs(schedule: Schedule, epochs: int) -> Schedule:
    """The schedule with so many epochs of each layer."""
    return replace(schedule, layer=replace(schedule.layer, epochs=epochs))


def with_alpha(schedule: Schedule, alpha: float) -> Schedule:
    """The schedule with another α in the training of the layers."""
    return replace(schedule, layer=replace(schedule.layer, alpha=alpha))


def _active(networks: SmallNetworks, manifolds: list[MotionManifold]) -> list[float]:
    """The share of hidden units that are active, of each network."""
    shares = []
    for manifold in manifolds:
        test = networks.clips(manifold)
        units = manifold.network.encode(test.x)[test.real[:, :: manifold.stride]]
        shares.append(float(np.mean(np.abs(units) > ACTIVE)))
    return shares


def _claim(key: str, errors: dict[str, list[Errors]], *without: str) -> Claim:
    """Whether the paper's training repairs better than each training without one of its choices."""
    ours = [of_seed.repair for of_seed in errors[AS_PAPER]]
    is_lower = []
    listed = []
    for name in without:
        theirs = [of_seed.repair for of_seed in errors[name]]
        is_lower.append(seeds_below(ours, theirs))
        listed.append(f"{name} {mean_and_range(theirs)} cm")
    figures = f"half removed, {mean_and_range(ours)} cm;"
    return Claim(key, all_of(*is_lower), figures, opponent=f"{'; '.join(listed)}.")


def _claims_of_sparsity(active: dict[str, list[float]]) -> list[Claim]:
    """Whether the sparsity term lowers the number of active units, and whether it halves it."""
    ours = active[AS_PAPER]
    theirs = active[FREE]
    halves = [share / 2 for share in theirs]
    figures = f"{mean_and_range(ours)} of the units are active with α = 0.01;"
    opponent = f"with α = 0 {mean_and_range(theirs)}."
    return [
        Claim("sparsity", seeds_below(ours, theirs), figures, opponent=opponent),
        Claim("sparsity_minimum", seeds_below(ours, halves), figures, opponent=opponent),
    ]


class FirstLayer(NamedTuple):
    """The mean magnitude of the correlation of two units of layer 1, and the mean number of joints
    and of frames that have nine tenths of the energy of a filter's response."""

    correlation: float
    joints: float
    frames: float

    HEADER = ("correlation", "joints", "frames")


def _compare_features(
    networks: SmallNetworks, manifolds: dict[str, list[MotionManifold]]
) -> tuple[Table, list[Claim]]:
    """The features of layer 1 with and without the sparsity term, before and after fine tuning,
    beside untrained ones."""
    untrained = _first_layers(networks, networks.learn(UNTRAINED))
    rows = []
    claims = []
    for stage, names in STAGES.items():
        sparse, free = (_first_layers(networks, manifolds[name]) for name in names)
        rows.append(_row_of_features(names[0], sparse))
        rows.append(_row_of_features(names[1], free))
        claims += _claims_of_features(stage, sparse, free, untrained)
    rows.append(_row_of_features("untrained", untrained))
    return Table("Layer 1:", ["training", *FirstLayer.HEADER], rows), claims


def _first_layers(networks: SmallNetworks, manifolds: list[MotionManifold]) -> list[FirstLayer]:
    """The features of layer 1 of each network, in the test windows."""
    measured = []
    for manifold in manifolds:
        test = networks.clips(manifold)
        units = manifold.network.encode(test.x, layers=1)[test.real[:, ::2]]
        energy = energy_of_responses(manifold, units, 1)
        joints = float(count_columns(energy.sum(axis=1)).mean())
        frames = float(count_columns(energy.sum(axis=2)).mean())
        measured.append(FirstLayer(correlation_of(units), joints, frames))
    return measured


def _row_of_features(name: str, of_seeds: list[FirstLayer]) -> list[object]:
    return [name, *(mean_and_range(column) for column in zip(*of_seeds, strict=True))]


def _claims_of_features(
    stage: str, sparse: list[FirstLayer], free: list[FirstLayer], untrained: list[FirstLayer]
) -> list[Claim]:
    """Whether features are more independent, and whether they are more local, than with α = 0."""
    below = _compare_layers(sparse, free)
    untrained_below = _compare_layers(untrained, free)
    ours = _row_of_features("", sparse)[1:]
    theirs = _row_of_features("", free)[1:]
    of_untrained = _row_of_features("", untrained)[1:]
    local = all_of(below.joints, below.frames)
    untrained_local = all_of(untrained_below.joints, untrained_below.frames)
    return [
        Claim(
            "sparsity_independent",
            below.correlation,
            f"two units correlate {ours[0]};",
            stage,
            f"with α = 0 {theirs[0]}, untrained {of_untrained[0]}.",
            "an untrained network" if untrained_below.correlation else "",
        ),
        Claim(
            "sparsity_local",
            local,
            f"{ours[1]} joints, {ours[2]} frames;",
            stage,
            f"with α = 0 {theirs[1]} and {theirs[2]}, untrained {of_untrained[1]} and "
            f"{of_untrained[2]}.",
            "an untrained network" if untrained_local else "",
        ),
    ]


class IsBelow(NamedTuple):
    """Whether each number of a `FirstLayer` is lower than that of another one with each seed."""

    correlation: bool | None
    joints: bool | None
    frames: bool | None


def _compare_layers(ours: list[FirstLayer], theirs: list[FirstLayer]) -> IsBelow:
    columns = zip(zip(*ours, strict=True), zip(*theirs, strict=True), strict=True)
    return IsBelow(*(seeds_below(*pair) for pair in columns))


def _claim_of_alpha(errors: dict[str, list[Errors]]) -> Claim:
    """Whether errors with α of means and of norms are nearly the same."""
    differences = {}
    for name in (SPARSE, FREE):
        pairs = zip(errors[name], errors[AS_PAPER], strict=True)
        differences[name] = [theirs.repair / ours.repair - 1 for theirs, ours in pairs]
    is_same = agreed([bool(abs(gap) <= SAME) for gap in differences[SPARSE]])
    listed = ", ".join(f"{gap:+.1%}" for gap in differences[SPARSE])
    without = ", ".join(f"{gap:+.1%}" for gap in differences[FREE])
    figures = f"the errors with the paper's α differ by {listed};"
    return Claim("alpha_of_norms", is_same, figures, opponent=f"with α = 0 by {without}.")


class MeanPooled(ConvLayer):
    """A layer that takes the mean of each pair of frames."""

    def encode_with_pullback(self, x: np.ndarray) -> tuple[np.ndarray, Pullback]:
        """As `ConvLayer.encode_with_pullback`, with the mean instead of the maximum."""
        convolved, convolve_pullback = ops.conv1d(x, self.w, self.b)
        y, tanh_pullback = ops.tanh((convolved[:, ::2] + convolved[:, 1::2]) / 2)

        def pullback(dy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            return convolve_pullback(np.repeat(tanh_pullback(dy) / 2, 2, axis=1))

        return y, pullback


def plain(model: Any) -> ConvAutoencoder:
    """The network by the plain definitions, on the same weights."""
    network = ConvAutoencoder(filters=[layer.b.size for layer in model.layers])
    network.layers = list(model.layers)
    return network


def mean_pooled(model: Any) -> ConvAutoencoder:
    """The network whose layers take the mean of each pair of frames, on the same weights."""
    network = plain(model)
    network.layers = [MeanPooled(layer.w, layer.b, layer.bound) for layer in model.layers]
    return network


def _compare_pooling(networks: SmallNetworks, schedule: Schedule) -> tuple[Table, Claim]:
    """Networks of one layer with the maximum and with the mean of each pair."""
    alone = replace(schedule, fine_tuning=replace(schedule.fine_tuning, epochs=0))
    engines = {"the maximum": plain, "the mean": mean_pooled}
    correlations = {}
    for name, engine in engines.items():
        manifolds = networks.learn_with(name, engine, alone, filters=FILTERS[:1])
        correlations[name] = []
        for manifold in manifolds:
            test = networks.clips(manifold)
            units = engine(manifold.network).encode(test.x)[test.real[:, ::2]]
            correlations[name].append(correlation_of(units))
    rows = [[name, mean_and_range(values)] for name, values in correlations.items()]
    maximum, mean = correlations.values()
    claim = Claim(
        "pooling_separates",
        seeds_below(maximum, mean),
        f"two units correlate {mean_and_range(maximum)} with the maximum;",
        opponent=f"with the mean {mean_and_range(mean)}.",
    )
    return Table("One layer:", ["of each pair", "correlation of two units"], rows), claim
