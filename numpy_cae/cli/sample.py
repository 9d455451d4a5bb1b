"""`numpy-cae sample -m model.npz -o out.bvh`: draw new motions from a prior."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import one_motion
from numpy_cae.manifold import (
    MotionManifold,
    NeighbourPrior,
    SequenceManifold,
    sample,
    sample_sequence,
)
from numpy_cae.manifold.sample import encode_windows
from numpy_cae.motion import (
    Motion,
    RootTransform,
    body_of,
    features_to_positions,
    fit_motion,
    load_body,
)
from numpy_cae.motion.body import hold_first_pose

FITTED, UNIFORM = "fitted", "uniform"
MAX_DRAWN = 5


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand and its arguments."""
    parser = subparsers.add_parser(
        "sample",
        help="sample new motions from a manifold",
        description="Draw new motions from a learned manifold and write them as BVH. The fitted "
        "prior mixes similar windows of the motions in --data; the uniform prior of holden2015, "
        "section 3, needs no data, but its samples hardly resemble motion. From a sequential model "
        "clips are drawn from its own prior and joined.",
        epilog="example: numpy-cae sample -m model.npz --data motions/ -o new.bvh --number 3 "
        "--seconds 8 --like take.bvh",
    )
    one_motion.add_model_arguments(
        parser, f"path of an animation of the first {MAX_DRAWN} motions"
    )
    add = parser.add_argument
    add("--prior", choices=(FITTED, UNIFORM), default=FITTED, help=f"prior (default: {FITTED})")
    one_motion.add_data_argument(
        parser, "folders of motions that the prior is fitted to, such as the training motions"
    )
    add(
        "--number",
        type=kinds.positive_number,
        default=1,
        metavar="N",
        help="number of motions; several are written as new_1.bvh, new_2.bvh, … (default: 1)",
    )
    add("--seconds", type=kinds.positive, default=5.0, help="length of each motion (default: 5)")
    add("--seed", type=kinds.whole_number, default=0, help="seed of the draws (default: 0)")
    add("--like", type=Path, metavar="FILE", help="motion file whose rig, rate and unit are used")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Draw and write the motions."""
    manifold = one_motion.load_model(args)
    rng = np.random.default_rng(args.seed)
    frames = max(1, round(args.seconds * manifold.rate))
    if isinstance(manifold, SequenceManifold):
        if args.data or args.like:
            unused = "--data" if args.data else "--like"
            raise ValueError(f"{args.model}: {unused} has no effect on a sequential model, which "
                             "has a prior and bones of its own")  # fmt: skip
        made = [sample_sequence(manifold, frames, rng) for _ in range(args.number)]
        return _write(args, made, None)
    prior = _prior(args, manifold)
    mapping = kinds.chosen_mapping(args) if args.like else None
    rig = load_body(args.like, mapping, args.unit)[1] if args.like else None
    features = [sample(manifold, frames, rng, prior) for _ in range(args.number)]
    return _write(args, [_motion(manifold, each, rig, mapping) for each in features], mapping)


def _prior(args: argparse.Namespace, manifold: MotionManifold) -> NeighbourPrior | None:
    if args.prior == UNIFORM:
        return None
    if not args.data:
        raise ValueError(
            "the fitted prior requires motions: name a folder of them with --data, or use "
            "--prior uniform"
        )
    return NeighbourPrior(encode_windows(manifold, one_motion.load_features(args, manifold)))


def _motion(
    manifold: MotionManifold, features: np.ndarray, rig: Motion | None, mapping: one_motion.Mapping
) -> Motion:
    if rig is None:
        return fit_motion(features_to_positions(features), manifold.lengths, manifold.rate)
    body = manifold.body(hold_first_pose(rig, len(features)), mapping)
    return body.to_rig(features, RootTransform())


def _write(args: argparse.Namespace, made: list[Motion], mapping: one_motion.Mapping) -> int:
    for number, motion in enumerate(made, start=1):
        stem = args.output.stem if len(made) == 1 else f"{args.output.stem}_{number}"
        one_motion.write_motion(motion, args.output.with_stem(stem))
    if args.gif:
        from numpy_cae.viz import PROJECTED

        bodies = [body_of(motion, mapping) for motion in made[:MAX_DRAWN]]
        titles, colours = [""] * len(bodies), [PROJECTED] * len(bodies)
        one_motion.draw(args.gif, bodies, titles, colours, 30.0, "what was drawn")
    return 0
