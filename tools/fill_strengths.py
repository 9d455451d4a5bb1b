"""Measure the candidates of `fill` in holes of sources left out of training.

    numpy-cae train bandai -o no_cmu.npz --recipe fast
    python -m tools.fill_strengths no_cmu.npz cmu/asfamc \
        -o numpy_cae/cleanup/fill_strengths.json

Each model is followed by a folder of motions of a source that the model did not learn from. In
takes of the source, spread over the folder, holes of each kind and length are filled by every
candidate of `numpy_cae.cleanup.holes`. The table that is written has the mean over the holes of

    r_k = log e_k - log e_0

with e_k the mean error of candidate k in a hole, and candidate 0 the first curve, the share 0 and
the strength 0. Bandai Namco's set is not in the folder, so that the results of the starter model on
it are not those of a choice on it.
"""

import argparse
import json
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.cleanup.holes import (
    CORRECTED,
    LEAST_ERROR_METRES,
    POWERS,
    STRENGTHS,
    TURNED,
    Trials,
    correct_body,
    interpolate_body,
    measure_errors,
    regress_body,
    weights,
)
from numpy_cae.cleanup.interpolation import interpolate_joints, mark_unknown_channels
from numpy_cae.cleanup.joint_regression import blend_rotations, regress_rotations
from numpy_cae.manifold import MotionManifold, load_manifold
from numpy_cae.mocap import find_motion_files, load_motion
from numpy_cae.mocap.retargeting.body import Body
from numpy_cae.motion import JOINTS, RATE, Motion
from numpy_cae.motion.hole_curves import CURVES, Curve, mean_curve
from numpy_cae.motion.joints import LIMBS, joint_mask
from studies.shared.material import evenly

PARTS = {
    "end": [["left_wrist"], ["right_wrist"]],
    "arm": [LIMBS["left_arm"], LIMBS["right_arm"]],
    "leg": [LIMBS["left_leg"], LIMBS["right_leg"]],
    "pose": [JOINTS],
}
LENGTHS = (10, 20, 45, 90)
"""Lengths of holes, in frames at 30 a second. Between two of them r is interpolated over the
logarithm of the length; shorter holes have that of the shortest, longer ones of the longest."""
TAKES = 14
"""Of each source so many takes get holes."""
SECONDS = 7.0
"""Holes are in so many first seconds of a take."""
Part = tuple[str, int]
"""Kind and length of hole."""
Logs = dict[Part, list[np.ndarray]]
"""For each hole the logarithms of the candidates' errors."""


def errors_of(
    manifold: MotionManifold, folder: Path, curves: dict[Part, Curve], shares: dict[Part, float]
) -> Logs:
    """The logarithms of the errors in takes of a folder: of the curves if `curves` is empty, else
    of the shares on these curves if `shares` is empty, else of the strengths on both."""
    logs: Logs = defaultdict(list)
    for number, path in enumerate(evenly(find_motion_files(folder), TAKES)):
        motion = load_motion(path)
        motion = motion.at(slice(round(SECONDS * motion.rate)))
        body = Body(motion, manifold.lengths)
        for part, mask in holes_in(motion, np.random.default_rng(number)):
            frames = np.flatnonzero(mask.any(axis=1))
            hole = Trials(np.where(mask, part[0], ""), [int(frames[0])], len(frames))
            if curves:
                start = interpolate_joints(motion, mask, lambda *_, part=part: curves[part])
                unknown, _ = mark_unknown_channels(motion, mask)
                regressed = list(regress_rotations(body, unknown, mask))
            if shares:
                start = blend_rotations(start, regressed, lambda *_, part=part: shares[part])
                candidates = correct_body(manifold, body, mask, start)
            elif curves:
                candidates = regress_body(start, regressed)
            else:
                candidates = (interpolate_body(body, mask, curve) for curve in CURVES.values())
            errors = measure_errors(body, hole, candidates)[part[0]]
            logs[part].append(np.log(np.maximum(errors[0], LEAST_ERROR_METRES)))
    return logs


def holes_in(motion: Motion, rng: np.random.Generator) -> Iterator[tuple[Part, np.ndarray]]:
    """A mask (frames, 20) for each kind and length that fits into the motion."""
    for kind, sides in PARTS.items():
        for length in LENGTHS:
            frames = round(length * motion.rate / RATE)
            margin = round(motion.rate / 2)
            room = len(motion) - frames - 2 * margin
            if room > 0:
                first = margin + int(rng.integers(room))
                joints = sides[rng.integers(len(sides))]
                mask = joint_mask(len(motion), joints, slice(first, first + frames))
                yield (kind, length), mask


def mean_of(sources: list[Logs]) -> dict[Part, np.ndarray]:
    """r of the module's equation."""
    means = {}
    for part in sources[0]:
        rows = np.concatenate([logs[part] for logs in sources])
        means[part] = np.mean(rows - rows[:, :1], axis=0)
    return means


def by_kind(means: dict[Part, np.ndarray], kinds: Iterable[str]) -> dict[str, list[list[float]]]:
    """Kind of hole to a row of the table for each length."""
    table = {}
    for kind in kinds:
        table[kind] = [means[kind, length].round(3).tolist() for length in LENGTHS]
    return table


def main() -> None:
    """Measure each source and write the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("pairs", nargs="+", type=Path, metavar="MODEL FOLDER")
    parser.add_argument("-o", "--output", type=Path, required=True)
    args = parser.parse_args()
    manifolds = [load_manifold(model) for model in args.pairs[::2]]
    pairs = list(zip(manifolds, args.pairs[1::2], strict=True))
    of_curves = mean_of([errors_of(*pair, {}, {}) for pair in pairs])
    curves = {part: mean_curve(weights(r, None, POWERS["curves"])) for part, r in of_curves.items()}
    of_shares = mean_of([errors_of(*pair, curves, {}) for pair in pairs])
    shares = {}
    for part, r in of_shares.items():
        shares[part] = 0.0
        if part[0] in TURNED:
            shares[part] = float(weights(r, None, POWERS["shares"]) @ STRENGTHS)
    of_strengths = mean_of([errors_of(*pair, curves, shares) for pair in pairs])
    table = {
        "made by": " ".join(map(str, ["python -m tools.fill_strengths", *args.pairs])),
        "lengths": LENGTHS,
        "curves": by_kind(of_curves, PARTS),
        "shares": by_kind(of_shares, TURNED),
        "strengths": by_kind(of_strengths, CORRECTED),
    }
    with atomic_write(args.output) as path:
        path.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
