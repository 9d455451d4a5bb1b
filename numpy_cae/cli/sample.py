"""`numpy-cae sample -m model.npz -o out.bvh`: motion that nobody made, drawn from a prior."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from numpy_cae.cli import arguments as kinds
from numpy_cae.manifold import (
    MotionManifold,
    NeighbourPrior,
    is_sequential,
    load_manifold,
    load_sequences,
    sample,
    sample_sequence,
)
from numpy_cae.manifold.in_rig import in_rig, standing_still
from numpy_cae.manifold.sample import encode_windows
from numpy_cae.motion import (
    PARENTS,
    Motion,
    RootTransform,
    body_of,
    features_to_positions,
    find_motion_files,
    fit_motion,
    load_body,
    write_bvh,
)
from numpy_cae.viz import PROJECTED, Actor, save_gif

FITTED, UNIFORM = "fitted", "uniform"


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """A model in, new motions out."""
    parser = subparsers.add_parser(
        "sample",
        help="draw new motions from a manifold",
        description="Draw new motions from a learned manifold and write them as BVH. The fitted "
        "prior mixes windows of the motions in --data that are alike; the uniform one of "
        "holden2015, section 3, needs none, and what it gives is hardly motion. From a sequential "
        "model clips of its own prior are drawn and joined.",
        epilog="example: numpy-cae sample -m model.npz --data motions/ -o new.bvh --number 3 "
        "--seconds 8 --like take.bvh",
    )
    add = parser.add_argument
    add("-m", "--model", type=Path, required=True, help="from `numpy-cae train`")
    add("-o", "--output", type=Path, required=True, help="the .bvh file to write")
    add("--prior", choices=(FITTED, UNIFORM), default=FITTED, help=f"default: {FITTED}")
    add(
        "--data",
        type=Path,
        nargs="+",
        metavar="FOLDER",
        default=[],
        help="motions that the prior is fitted to, such as those that the model learned from",
    )
    add(
        "--number",
        type=kinds.positive_number,
        default=1,
        metavar="N",
        help="of motions; more than one are written as new_1.bvh, new_2.bvh, … (default: 1)",
    )
    add("--seconds", type=kinds.positive, default=5.0, help="of each (default: 5)")
    add("--seed", type=kinds.whole_number, default=0, help="of what is drawn (default: 0)")
    add("--like", type=Path, metavar="FILE", help="write in the rig, rate and unit of this motion")
    add("--gif", type=Path, help="draw the motions, moving (the first five)")
    kinds.add_motion_arguments(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read what the prior needs, draw, write."""
    if args.output.suffix.lower() != ".bvh":
        raise ValueError(f"{args.output}: a new motion is written as .bvh")
    if is_sequential(args.model):
        return _sample_sequences(args)
    manifold = load_manifold(args.model)
    prior = _prior(args, manifold)
    like = None
    if args.like:
        _, like = load_body(args.like, kinds.chosen_mapping(args), args.unit)
    rng = np.random.default_rng(args.seed)
    frames = max(1, round(args.seconds * manifold.rate))
    made = [
        _motion(args, manifold, sample(manifold, frames, rng, prior), like)
        for _ in range(args.number)
    ]
    return _write(args, made, kinds.chosen_mapping(args) if like else None)


def _sample_sequences(args: argparse.Namespace) -> int:
    """From jang2018's prior, the standard normal; clips blended where it takes more than one."""
    if args.data or args.like:
        unused = "--data" if args.data else "--like"
        raise ValueError(f"{args.model}: a sequential model has a prior and bones of its own, "
                         f"leave out {unused}")  # fmt: skip
    manifold, rng = load_sequences(args.model), np.random.default_rng(args.seed)
    frames = max(1, round(args.seconds * manifold.rate))
    return _write(args, [sample_sequence(manifold, frames, rng) for _ in range(args.number)], None)


def _write(args: argparse.Namespace, made: list[Motion], mapping: dict[str, str] | None) -> int:
    for path, motion in zip(_paths(args.output, args.number), made, strict=True):
        write_bvh(motion, path)
        print(f"{path}: {len(motion)} frames at {motion.rate:g} a second")
    if args.gif:
        shown = [body_of(motion, mapping) for motion in made[:5]]
        save_gif([Actor(body, PARENTS, "", PROJECTED) for body in shown], args.gif, 30.0)
        print(f"{args.gif}: what was drawn")
    return 0


def _prior(args: argparse.Namespace, manifold: MotionManifold) -> NeighbourPrior | None:
    if args.prior == UNIFORM:
        return None
    if not args.data:
        raise ValueError(
            "the fitted prior is fitted to motions: name a folder of them with --data, or draw "
            "from --prior uniform"
        )
    mapping = kinds.chosen_mapping(args)
    files = [path for folder in args.data for path in find_motion_files(folder)]
    takes = [manifold.features(load_body(path, mapping, args.unit)[0])[0] for path in files]
    return NeighbourPrior(encode_windows(manifold, takes))


def _motion(
    args: argparse.Namespace, manifold: MotionManifold, features: np.ndarray, like: Motion | None
) -> Motion:
    if like is None:
        return fit_motion(features_to_positions(features), manifold.lengths, manifold.rate)
    rig = standing_still(like, len(features))
    return in_rig(manifold, features, RootTransform(), rig, kinds.chosen_mapping(args))


def _paths(output: Path, number: int) -> list[Path]:
    if number == 1:
        return [output]
    return [output.with_stem(f"{output.stem}_{n + 1}") for n in range(number)]
