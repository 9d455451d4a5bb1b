"""Draw new motions from a learned manifold and write them as BVH. The prior mixes similar windows
of the motions in --data; without --data it is uniform, and its samples hardly resemble motion. A
sequential model draws clips of its own length from its own prior.

examples, of which the first makes synthetic motions:
  python -m data_synth walks --minutes 2 --kinds walk
  numpy-cae sample --data walks/ -o new.bvh --number 3 --like walks/01/01_01.bvh --html
"""

import argparse

import numpy as np

from numpy_cae.cli.shared import arguments, files
from numpy_cae.manifold import MotionManifold, NeighbourPrior, SequenceManifold, sample
from numpy_cae.manifold.sampling import encode_windows
from numpy_cae.mocap import Body, hold_first_pose, load_body, require_bvh
from numpy_cae.motion import RATE, Motion, features_to_positions
from numpy_cae.motion.features import RootTransform
from numpy_cae.motion.fit import fit_motion
from numpy_cae.viz import PROJECTED, motion_actor

SECONDS = 5.0
MOST_MOTIONS = 10_000
"""All motions are drawn before the first is written."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The model, the prior, and the number and length of the motions."""
    files.add_output_arguments(parser)
    files.add_model_arguments(parser)
    add = parser.add_argument
    add("--data", **arguments.FOLDERS, help="folders of motions that the prior is fitted to")
    add("--number", **arguments.COUNT, default=1, help="number of motions (default: 1)")
    add("--seconds", type=arguments.positive, help=f"length of each motion (default: {SECONDS:g})")
    add("--like", **arguments.FILE, help="motion file whose rig, rate and unit are used")
    arguments.add_shared(parser, "seed")


def run(args: argparse.Namespace) -> int:
    """Draw and write the motions."""
    require_bvh(args.output)
    arguments.require_at_most("--number", args.number, MOST_MOTIONS)
    manifold = files.load_any_model(args)
    rng = np.random.default_rng(args.seed)
    if isinstance(manifold, SequenceManifold):
        if args.data or args.like or args.seconds:
            problem = "a sequential model takes no --data, --like and --seconds"
            raise ValueError(f"{args.model}: {problem}")
        motions = [manifold.sample(1, rng)[0] for _ in range(args.number)]
    else:
        motions = _draw(args, manifold, rng)
    for number, motion in enumerate(motions, start=1):
        stem = args.output.stem if args.number == 1 else f"{args.output.stem}_{number}"
        files.write(motion, args.output.with_stem(stem))
    if args.html:
        actors = [
            motion_actor(motion, f"sample {number}", PROJECTED, RATE)
            for number, motion in enumerate(motions, start=1)
        ]
        files.write_page(args.output, f"{args.number} drawn from the prior", actors)
    return 0


def _draw(
    args: argparse.Namespace, manifold: MotionManifold, rng: np.random.Generator
) -> list[Motion]:
    """Draw motions from a convolutional model, in the rig of --like if given."""
    prior = None  # uniform
    if args.data:
        bodies = files.read_bodies(args, list(files.named_files(args.data)))
        encoded = [manifold.features(positions)[0] for _, positions in bodies]
        prior = NeighbourPrior(encode_windows(manifold, encoded))
    frames = max(1, round((args.seconds or SECONDS) * manifold.rate))
    like = load_body(args.like, **arguments.reading(args))[1] if args.like else None
    drawn = [sample(manifold, frames, rng, prior) for _ in range(args.number)]
    if like:
        body = Body(hold_first_pose(like, frames), manifold.lengths)
        return [body.to_rig(features, RootTransform()) for features in drawn]
    return [
        fit_motion(features_to_positions(features), manifold.lengths, manifold.rate)
        for features in drawn
    ]
