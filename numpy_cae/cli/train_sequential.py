"""`numpy-cae train --model sequential`: motions of one action to a manifold of clips (jang2018)."""

from __future__ import annotations

import argparse
import sys

from numpy_cae.cli import arguments as kinds
from numpy_cae.cli.as_json import print_json
from numpy_cae.experiments.sequences.actions import read_action
from numpy_cae.experiments.sequences.figure_3 import figure_3
from numpy_cae.experiments.sequences.reconstruction import reconstruction
from numpy_cae.experiments.sequences.study import Study
from numpy_cae.manifold import learn_sequences, save_manifold
from numpy_cae.manifold.learning import HIDDEN, LATENT
from numpy_cae.motion import ANGLE_RATE, CLIP
from numpy_cae.training import Checkpoint, SequenceSchedule

CHOSEN = SequenceSchedule()
SHARED = {
    "command", "run", "model", "folders", "output", "test", "picture", "mapping", "unit", "seed",
    "quiet", "resume", "checkpoint", "json",
}  # fmt: skip
"""Options that mean the same for both models."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of this model, in a group of their own."""
    group = parser.add_argument_group(
        "with --model sequential",
        "jang2018's network, for motions of one action; --picture draws samples. The paper states "
        "none of these numbers.",
    )
    add = group.add_argument
    add("--hidden", type=kinds.positive_number, default=HIDDEN, help="units of each GRU")
    add("--latent", type=kinds.positive_number, default=LATENT, help="numbers of z")
    add("--frames", type=kinds.positive_number, default=CLIP, help="of a clip, 25 a second")
    add("--sequence-epochs", type=kinds.whole_number, default=CHOSEN.epochs, help="in all")
    add("--steps", type=kinds.positive_number, default=CHOSEN.steps, help="in an epoch")
    add("--sequence-rate", type=kinds.rate, default=CHOSEN.rate, help="of the first epoch")
    add("--sequence-decay", type=kinds.rate, default=CHOSEN.decay, help="of the rate, an epoch")
    add("--sequence-batch", type=kinds.positive_number, default=CHOSEN.batch, help="clips a step")
    add("--weight", type=kinds.rate, default=CHOSEN.weight, help="λ of the regulariser")
    add("--directions", type=kinds.positive_number, default=CHOSEN.directions, help="of slices")
    add("--norm", type=kinds.positive, default=CHOSEN.norm, help="bound of the gradient's norm")
    add("--posture", type=kinds.rate, default=CHOSEN.posture, help="deviation of drawn postures")
    add("--momentum", type=kinds.fraction, default=CHOSEN.momentum, help="of descent; below 1")


def options() -> set[str]:
    """Their names."""
    parser = argparse.ArgumentParser(add_help=False)
    add_arguments(parser)
    return set(vars(parser.parse_args([])))


def require_own_options(args: argparse.Namespace, parser: argparse.ArgumentParser) -> None:
    """Raise ValueError where an option of the other model is given."""
    ours = options()
    for name, value in vars(args).items():
        other = (name in ours) != (args.model == "sequential")
        if name not in SHARED and other and value != parser.get_default(name):
            raise ValueError(f"--{name.replace('_', '-')} is no option of the {args.model} model")


def schedule_of(args: argparse.Namespace) -> SequenceSchedule:
    """The schedule that the options describe."""
    return SequenceSchedule(
        epochs=args.sequence_epochs,
        steps=args.steps,
        rate=args.sequence_rate,
        decay=args.sequence_decay,
        batch=args.sequence_batch,
        weight=args.weight,
        directions=args.directions,
        norm=args.norm,
        momentum=args.momentum,
        posture=args.posture,
    )


def run(args: argparse.Namespace, checkpoint: Checkpoint) -> int:
    """Read, train, save, measure."""
    name = args.folders[0].resolve().name
    action = read_action(name, args.folders, args.test, kinds.chosen_mapping(args), args.unit)
    if args.test and not action.testing:
        raise ValueError(f"no file matches {' '.join(args.test)}, none is left to test")
    if not action.training:
        raise ValueError(f"every file matches {' '.join(args.test)}, none is left to train")
    seconds = sum(map(len, action.training)) / ANGLE_RATE
    print(
        f"{len(action.training)} motions to train on ({seconds / 60:.1f} min), "
        f"{len(action.testing)} to test",
        file=sys.stderr,
    )
    manifold = learn_sequences(
        action.training,
        schedule_of(args),
        seed=args.seed,
        hidden=args.hidden,
        latent=args.latent,
        frames=args.frames,
        show_progress=not args.quiet,
        checkpoint=checkpoint,
    )
    manifold.settings["test"] = args.test
    save_manifold(manifold, args.output)
    checkpoint.remove()
    trained = Study(action, manifold)
    table = reconstruction([trained]) if action.testing else None
    if args.picture:
        figure_3(trained).save_picture(args.picture)
    if args.json:
        print_json({"model": args.output, "settings": manifold.settings, "test": table and table.data()})
        return 0
    print(f"{args.output}: learned clips of {args.frames} frames of {len(action.training)} motions")
    if table:
        print(f"\n{table.text()}")
    if args.picture:
        print(f"\n{args.picture}: samples")
    return 0
