"""Values removed with probability p from 0.1 to 0.9, repaired by the network and by baselines:
holden2015, section 7, "Fixing Corrupt Motion Data".

The methods are those of `numpy_cae.evaluation.tables`, grouped by what they are given: the
zeros as they are or, from "mask:" on, which values are missing. Errors are root mean squares of a
coordinate in at most 60 windows of the test takes. Baselines are fitted to the training takes; PCA
has the number of axes that is best on the test takes, which favours PCA.

    python -m studies repair_sweep --data bandai -m best.npz -o sweep

-o FOLDER also writes a page of one window with half, 80% and 90% of its values removed, repaired by
each method, moving.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.evaluation import tables
from numpy_cae.evaluation.tables import Clips, Repairs, clips_of
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.weighted_completion import complete_weighted
from numpy_cae.training import zero_values
from numpy_cae.viz import CORRUPTED, OTHERS, PLAIN, PROJECTED, TRUTH
from studies.shared.judging import ratio_of_errors, root_mean_square
from studies.shared.material import Material, testing_of
from studies.shared.result import Claim, Picture, Result, Table, moving

PS = (0.1, 0.3, tables.P, 0.8, 0.9)
DRAWN = {
    tables.DAMAGED: CORRUPTED,
    tables.NETWORK: PROJECTED,
    tables.PCHIP: OTHERS[0],
    tables.GAUSSIAN: OTHERS[1],
    tables.COMPLETED: PLAIN,
}
"""The methods that are drawn, and their colours."""
WINDOWS = 60
"""At most this many windows are repaired, since the Gaussian takes a tenth of a second for
each."""
WITHOUT_NETWORK = "mask: completed without the network"
OVER_ZEROS = "a monotone cubic between the values that are not zero"
"""PCHIP as an opponent of methods that are given the zeros: a removed value is zero, and no other
one is."""
Errors = dict[str, np.ndarray]
"""Method to its errors in cm, one for each p and each seed."""


def run(
    manifold: MotionManifold, material: Material, seed: int = 0, shares: tuple[float, ...] = PS
) -> Result:
    """Remove shares of the values of test windows, drawn from the seed, and repair them with every
    method."""
    return judge(manifold, material, measure_motion(manifold, material, seed, shares))


@dataclass(frozen=True, eq=False)
class MeasuredMotion:
    """What was measured without a network: the fitted baselines, and for each share of removed
    values the squared errors by take of each method."""

    repairs: Repairs
    squares: dict[float, dict[str, np.ndarray]]
    seed: int


def measure_motion(
    manifold: MotionManifold, material: Material, seed: int = 0, shares: tuple[float, ...] = PS
) -> MeasuredMotion:
    """Everything that needs no network: of the manifold only its features and its context."""
    training = clips_of(manifold, [take.positions for take in material.training])
    test = testing_of(manifold, material)[0].pick_evenly(WINDOWS)
    repairs = Repairs(manifold, training)
    squares = {}
    for p in shares:
        damaged = zero_values(test.x, p, np.random.default_rng(seed))
        simple = repairs.apply_simply(test, damaged, p)
        with_mask = repairs.apply_with_mask(test, damaged, tables.SIMPLE_WITH_MASK)
        squares[p] = _squares(test, [*simple, *with_mask])
        if p == tables.P:
            squares[p][WITHOUT_NETWORK] = _squares_without_network(manifold, test, damaged)
    return MeasuredMotion(repairs, squares, seed)


def judge(manifold: MotionManifold, material: Material, motion: MeasuredMotion) -> Result:
    """What was measured without a network, beside the projection and the completion."""
    testing, _ = testing_of(manifold, material)
    test = testing.pick_evenly(WINDOWS)
    repairs = motion.repairs.of(manifold)
    errors: dict[str, list[float]] = defaultdict(list)
    claims: list[Claim] = []
    for p, squares in motion.squares.items():
        damaged = zero_values(test.x, p, np.random.default_rng(motion.seed))
        projected = repairs.project(test, damaged)
        completed = repairs.apply_with_mask(test, damaged, (tables.COMPLETED,))
        of_all = squares | _squares(test, [*projected, *completed])
        for method in tables.METHODS:
            errors[method].append(root_mean_square(of_all[method]))
        if p == tables.P:
            claims = _claims(of_all)
    rows = [[method, *of_method] for method, of_method in errors.items()]
    header = ["method", *(f"p = {p}" for p in motion.squares)]
    drawn = [p for p in motion.squares if p >= tables.P]
    window = testing.pick_evenly(1)
    return Result(
        "Repair: values removed with probability p",
        [Table("Error, cm:", header, rows)],
        claims,
        {f"removed_{p}": _picture(repairs, window, p, motion.seed) for p in drawn},
    )


def _squares(test: Clips, repaired: Sequence[tuple]) -> dict[str, np.ndarray]:
    """The squared errors of each method by take, of what `Repairs` yields."""
    return {method: test.squares_by_take(x) for method, _, x in repaired}


def _squares_without_network(
    manifold: MotionManifold, test: Clips, damaged: np.ndarray
) -> np.ndarray:
    """The squared errors by take of a completion as the manifold's, without its network."""

    def complete(x: np.ndarray, known: np.ndarray) -> np.ndarray:
        pairs = zip(x, known, strict=True)
        return np.stack([complete_weighted(*pair, None, manifold.context) for pair in pairs])

    known = damaged != 0
    return test.squares_by_take(tables.apply_to_real_frames(complete, test.real, damaged, known))


def _picture(repairs: Repairs, window: Clips, p: float, seed: int) -> Picture:
    """A window of which values are removed, as each method repairs it, beside the truth."""
    damaged = zero_values(window.x, p, np.random.default_rng(seed))
    with_mask = (tables.PCHIP, tables.GAUSSIAN, tables.COMPLETED)
    repaired = {tables.DAMAGED: damaged}
    projected = repairs.project(window, damaged)
    for method, _, x in [*projected, *repairs.apply_with_mask(window, damaged, with_mask)]:
        repaired[method] = x
    denormalise = repairs.manifold.denormalise
    motions = {}
    for method, colour in DRAWN.items():
        motions[method] = denormalise(repaired[method][0]), colour
    motions["the truth"] = denormalise(window.x[0]), TRUTH
    return moving(motions, repairs.manifold.rate)


def sweep(repairs: Repairs, test: Clips, ps: Sequence[float], seeds: Sequence[int]) -> Errors:
    """The errors of every method where values are removed with each p, drawn from each seed."""
    errors: dict[str, list[float]] = defaultdict(list)
    for p in ps:
        for seed in seeds:
            damaged = zero_values(test.x, p, np.random.default_rng(seed))
            for method, _, repaired in repairs.apply(test, damaged, p):
                errors[method].append(test.error(repaired))
    return {method: np.reshape(values, (len(ps), -1)) for method, values in errors.items()}


def _claims(squares: dict[str, np.ndarray]) -> list[Claim]:
    """The network, which is given the zeros as they are, beside the simple methods that are given
    as much; and the completion beside the simple methods that are given the mask."""
    errors = {name: root_mean_square(of_takes) for name, of_takes in squares.items()}
    before = squares[tables.DAMAGED]
    share_left = ratio_of_errors(squares[tables.NETWORK], before)
    simple = min(tables.SIMPLE, key=lambda name: errors[name])
    left_by_simple = ratio_of_errors(squares[simple], before)
    left_by_curve = ratio_of_errors(squares[tables.PCHIP], before)
    figures = (
        f"{errors[tables.DAMAGED]:.2f} cm before, {errors[tables.NETWORK]:.2f} cm after: "
        f"{share_left:.3f} of the error is left;"
    )
    opponent = (
        f"{simple}: {errors[simple]:.2f} cm, {left_by_simple:.3f}; {OVER_ZEROS}: "
        f"{errors[tables.PCHIP]:.2f} cm, {left_by_curve:.3f}."
    )
    claims = []
    for key, share in (("half_recovered", 0.1), ("matches_closely", 0.01)):
        bound = share**0.5
        also = []
        if left_by_simple.at_most(bound):
            also.append(simple)
        if left_by_curve.at_most(bound):
            also.append(OVER_ZEROS)
        fulfilled = share_left.at_most(bound)
        claims.append(Claim(key, fulfilled, figures, "", opponent, " and ".join(also)))
    claims.append(_claim_against(squares, "better_than_simple", tables.NETWORK, simple))
    with_mask = min(tables.SIMPLE_WITH_MASK, key=lambda name: errors[name])
    claims.append(_claim_of_information(squares, errors))
    claims.append(_claim_of_completion(squares, with_mask))
    claims.append(_claim_of_transitions(squares))
    return claims


def _claim_of_information(squares: dict[str, np.ndarray], errors: dict[str, float]) -> Claim:
    """Whether the values that are left say nothing of the removed half."""
    best = min(tables.SIMPLE_WITH_MASK, key=lambda name: errors[name])
    left = ratio_of_errors(squares[best], squares[tables.DAMAGED])
    figures = f"{best}: {errors[best]:.2f} cm, {left:.3f} of the error."
    return Claim("half_of_information", left.at_least(0.5**0.5), figures)


def _claim_of_completion(squares: dict[str, np.ndarray], simple: str) -> Claim:
    """Whether the completion has a lower error than the best simple method, and what is the
    network's part in it."""
    claim = _claim_against(squares, "completed_better", tables.COMPLETED, simple)
    of_network = ratio_of_errors(squares[tables.COMPLETED], squares[WITHOUT_NETWORK])
    opponent = f"{claim.opponent.rstrip('.')}; with the network {of_network:.2f} of without it."
    return replace(claim, opponent=opponent)


def _claim_of_transitions(squares: dict[str, np.ndarray]) -> Claim:
    """Whether the completion has a lower error than the Kalman smoother of poses; without the
    network it may have one too."""
    claim = _claim_against(squares, "transitions_afterwards", tables.COMPLETED, tables.DYNAMICS)
    without = ratio_of_errors(squares[WITHOUT_NETWORK], squares[tables.DYNAMICS])
    also = "the completion without the network" if without.below(1) else ""
    opponent = f"{claim.opponent.rstrip('.')}; completed without the network {without:.2f} of it."
    return replace(claim, opponent=opponent, fulfilled_by=also)


def _claim_against(squares: dict[str, np.ndarray], key: str, ours: str, opponent: str) -> Claim:
    """Whether a method has a lower error than an opponent."""
    ratio = ratio_of_errors(squares[ours], squares[opponent])
    figures = f"{root_mean_square(squares[ours]):.2f} cm, {ratio:.2f} of the opponent's;"
    of_opponent = f"{opponent}: {root_mean_square(squares[opponent]):.2f} cm."
    return Claim(key, ratio.below(1), figures, opponent=of_opponent)
