"""Choose how strongly the manifold corrects the rotation curves of `fill`, on sources left out.

    numpy-cae train bandai motions -o no_cmu.npz --recipe starter
    python docs/choose_fill_strengths.py no_cmu.npz cmu/asfamc \
        -o numpy_cae/manifold/fill_strengths.json

Each model is followed by a folder of motions of a source that the model did not learn from. In
takes of the source, spread over the folder, holes of each kind and length are filled with the
strengths 0, 0.1, …, 1. With r(s) = log (e(s) / e(0)), e(s) the mean error in a hole, the strength
of a kind and length is

    argmin_s  mean r(s) + 2 · standard error of that mean

over the holes of this length, which count twice, and of the next shorter and the next longer one.
The standard error keeps the strength small where it is uncertain whether a correction helps.
The end of a limb alone, such as a wrist, is not corrected: in 29 of 29 holes of another measurement
the corrected wrist was worse than the curve. Bandai Namco's set is not in the folder, so that the
results of the starter model on it are not those of a choice on it.
"""

import argparse
import json
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.experiments.material import evenly
from numpy_cae.manifold import MotionManifold, load_manifold
from numpy_cae.manifold.fill import corrected
from numpy_cae.manifold.holes import Holes
from numpy_cae.motion import JOINTS, RATE, Motion, find_motion_files, load_motion
from numpy_cae.motion.joints import LIMBS, joint_mask

PARTS = {
    "arm": [LIMBS["left_arm"], LIMBS["right_arm"]],
    "leg": [LIMBS["left_leg"], LIMBS["right_leg"]],
    "pose": [JOINTS],
}
STRENGTHS = np.linspace(0.0, 1.0, 11)
LENGTHS = (10, 20, 45, 90)
"""Lengths of holes, in frames at 30 a second. Between two of them the strength is interpolated over
the logarithm of the length; shorter holes have that of the shortest, longer ones of the longest."""
TAKES, SECONDS = 14, 7.0
"""Of each source so many takes get holes, in their first seconds."""
LEAST = 2e-4
"""Smaller errors (m) count as this."""
Errors = dict[tuple[str, int], list[np.ndarray]]
"""Kind and length of hole to the mean error at each of `STRENGTHS`, for each hole."""


def errors_of(manifold: MotionManifold, folder: Path) -> Errors:
    """The errors in takes of a folder."""
    errors: Errors = defaultdict(list)
    for number, path in enumerate(evenly(find_motion_files(folder), TAKES)):
        motion = load_motion(path)
        motion = motion.at(slice(round(SECONDS * motion.rate)))
        for hole, mask in holes_in(motion, np.random.default_rng(number)):
            errors[hole].append(errors_in(manifold, motion, mask))
    return errors


def holes_in(
    motion: Motion, rng: np.random.Generator
) -> Iterator[tuple[tuple[str, int], np.ndarray]]:
    """A mask (frames, 20) for each kind and length that fits into the motion."""
    for kind, sides in PARTS.items():
        for length in LENGTHS:
            frames, margin = round(length * motion.rate / RATE), round(motion.rate / 2)
            room = len(motion) - frames - 2 * margin
            if room > 0:
                first = margin + int(rng.integers(room))
                joints = sides[rng.integers(len(sides))]
                mask = joint_mask(len(motion), joints, slice(first, first + frames))
                yield (kind, length), mask


def errors_in(manifold: MotionManifold, motion: Motion, mask: np.ndarray) -> np.ndarray:
    """The mean error (m) in a hole at each strength."""
    body = manifold.body(motion)
    holes = Holes(body, mask)
    everything = np.ones(holes.mask.shape)
    full = corrected(manifold, holes.features, holes.mask, everything)
    start, end = map(holes.positions_of, (holes.features, full))
    mixed = start + STRENGTHS[:, None, None, None] * (end - start)
    distance = np.linalg.norm(mixed - body.positions, axis=-1)
    return np.maximum(distance[:, holes.mask].mean(axis=1), LEAST)


def chosen(sources: list[Errors]) -> dict[str, list[float]]:
    """The strength of each kind of hole at each of `LENGTHS`."""
    table: dict[str, list[float]] = {}
    for kind in PARTS:
        table[kind] = []
        for place in range(len(LENGTHS)):
            near = [LENGTHS[max(place - 1, 0) : place + 2], LENGTHS[place : place + 1]]
            holes = [e[kind, n] for lengths in near for n in lengths for e in sources]
            ratios = np.log(np.concatenate(holes))
            ratios -= ratios[:, :1]
            risk = ratios.mean(axis=0) + 2 * ratios.std(axis=0) / np.sqrt(len(ratios))
            table[kind].append(round(float(STRENGTHS[risk.argmin()]), 2))
    return table


def main() -> None:
    """Measure each source and write the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("pairs", nargs="+", type=Path, metavar="MODEL FOLDER")
    parser.add_argument("-o", "--output", type=Path, required=True)
    args = parser.parse_args()
    pairs = zip(args.pairs[::2], args.pairs[1::2], strict=True)
    sources = [errors_of(load_manifold(model), folder) for model, folder in pairs]
    table = chosen(sources)
    for kind, values in table.items():
        print(kind, *values)
    command = ["python docs/choose_fill_strengths.py", *args.pairs]
    made = {"made by": " ".join(map(str, command)), "lengths": LENGTHS, "strengths": table}
    with atomic_write(args.output) as path:
        path.write_text(json.dumps(made, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
