"""A wrist whose marker is missing for a whole clip: holden2015, section 7, figure 1, right.

    python -m studies wrist --data bandai --test '*_005.bvh' -m best.npz

A wrist that is missing in all frames has no curve over time, but it has the other joints of its
frame. Methods: the mean pose, which is zero for the network; the elbow, with the mean forearm of
the training takes in the body's own frame; ridge regression on the other joints of the frame, and
on those of frames -4, 0 and 4, fitted to windows of the training takes with a ridge that is chosen
on windows left out, which overlap with others (whole takes choose the same ridge, and have the same
error); the network, given zeros; and its completion, given the mask.
"""

from collections.abc import Callable
from functools import partial

import numpy as np

from numpy_cae.evaluation.joint_ridge import JointRidge
from numpy_cae.evaluation.tables import Clips, apply_to_real_frames, clips_of
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import joint_slice
from studies.shared.judging import ratio_of_errors, root_mean_square
from studies.shared.material import Material, testing_of
from studies.shared.result import Claim, Result, Table

MEAN_POSE = "the mean pose"
FOREARM = "the elbow and the mean forearm"
RIDGE = "ridge regression on the other joints"
RIDGE_OF_THREE = "ridge regression, frames -4, 0, 4"
NETWORK = "the network, given zeros"
COMPLETED = "mask: completed by the manifold"
SIMPLE = (FOREARM, RIDGE, RIDGE_OF_THREE)
LAGS = (-4, 0, 4)
WRISTS = ("left_wrist", "right_wrist")
INFERRED = 0.85
"""A wrist is inferred if its error is below this share of the mean pose's."""
TRAINING_WINDOWS = 400
"""Regressions are fitted to at most this many windows, evenly spaced."""
Repair = Callable[[np.ndarray], np.ndarray]
"""Takes windows (N, T, 63) without a wrist, and returns them with one."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Remove each wrist from test windows, and infer it with every method. The seed is not used."""
    testing, sample = testing_of(manifold, material)
    training = clips_of(manifold, [take.positions for take in material.training])
    training = training.pick_evenly(TRAINING_WINDOWS)
    squares: dict[str, list[np.ndarray]] = {}
    for wrist in WRISTS:
        missing = testing.x.copy()
        missing[..., joint_slice(wrist)] = 0
        for method, repair in methods_of(manifold, training, wrist).items():
            repaired = apply_to_real_frames(repair, testing.real, missing)
            squares.setdefault(method, []).append(testing.squares_by_take(repaired, wrist))
    rows = []
    both = {}
    for method, of_wrists in squares.items():
        both[method] = np.sum(of_wrists, axis=0)
        rows.append([method, *map(root_mean_square, of_wrists), root_mean_square(both[method])])
    caption = "Error at the missing joint, cm (root mean square of a coordinate):"
    table = Table(caption, ["method", *WRISTS, "both"], rows)
    return Result("A wrist that is missing for a whole clip", [table], _claims(both), note=sample)


def methods_of(manifold: MotionManifold, training: Clips, wrist: str) -> dict[str, Repair]:
    """The methods that infer a wrist, fitted to the training windows."""
    hidden = np.arange(63)[joint_slice(wrist)]
    takes = [x[real] for x, real in zip(training.x, training.real, strict=True)]
    elbow = joint_slice(wrist.replace("wrist", "elbow"))
    poses = np.concatenate(takes)
    forearm = (poses[:, hidden] - poses[:, elbow]).mean(axis=0)

    def put(x: np.ndarray, values: np.ndarray) -> np.ndarray:
        repaired = x.copy()
        repaired[..., hidden] = values
        return repaired

    def add_forearm(x: np.ndarray) -> np.ndarray:
        return put(x, x[..., elbow] + forearm)

    def regress(x: np.ndarray, fitted: JointRidge) -> np.ndarray:
        return put(x, np.stack([fitted.predict(window) for window in x]))

    def complete(x: np.ndarray) -> np.ndarray:
        known = np.ones(x.shape, bool)
        known[..., hidden] = False
        return manifold.complete_windows(x, known)

    return {
        MEAN_POSE: lambda x: x,
        FOREARM: add_forearm,
        RIDGE: partial(regress, fitted=JointRidge.fit(takes, hidden)),
        RIDGE_OF_THREE: partial(regress, fitted=JointRidge.fit(takes, hidden, LAGS)),
        NETWORK: manifold.project_windows,
        COMPLETED: complete,
    }


def _claims(squares: dict[str, np.ndarray]) -> list[Claim]:
    """Whether the network infers a wrist, and whether its completion is better than regression."""
    errors = {name: root_mean_square(of_takes) for name, of_takes in squares.items()}
    shares = {name: ratio_of_errors(squares[name], squares[MEAN_POSE]) for name in squares}
    simple = min(SIMPLE, key=lambda name: errors[name])
    opponent = f"{simple}: {errors[simple]:.2f} cm, {shares[simple]:.2f}."
    ratio = ratio_of_errors(squares[COMPLETED], squares[simple])
    inferring = [name for name in SIMPLE if shares[name].below(INFERRED)]
    return [
        Claim(
            "wrist_inferred",
            shares[NETWORK].below(INFERRED),
            f"{errors[NETWORK]:.2f} cm, {shares[NETWORK]:.2f} of the mean pose's "
            f"{errors[MEAN_POSE]:.2f} cm;",
            opponent=opponent,
            fulfilled_by=" and ".join(inferring),
        ),
        Claim(
            "wrist_better",
            ratio.below(1),
            f"completed {errors[COMPLETED]:.2f} cm, {ratio:.2f} of the opponent's;",
            opponent=opponent,
        ),
    ]
