"""`numpy-cae study -o FOLDER`: train for every result of jang2018 and measure it."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from numpy_cae.atomic_write import atomic_write
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import train_options
from numpy_cae.cli.as_json import add_json_argument, print_json

if TYPE_CHECKING:
    from numpy_cae.experiments.sequences.actions import Action

ACTIONS = ("walking", "waiting", "walking_dog")


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the parser of `study`."""
    parser = subparsers.add_parser(
        "study",
        help="run every experiment of jang2018 and write its results",
        description="Train jang2018's network on each action, with its regulariser and without, "
        "and write study.txt (the tables, and each claim with whether it held), figure 2, samples "
        "as strips and GIFs, and the models. Without --data the motions are made by data_synth.",
        epilog="example: numpy-cae study -o study; with motions of your own, one folder for each "
        "action: numpy-cae study --data cmu/walking --test 'walking_5.txt' -o study",
    )
    add = parser.add_argument
    output_help = "folder for all results; created if it does not exist"
    add("-o", "--output", type=Path, required=True, metavar="FOLDER", help=output_help)
    data_help = "folders of motion files, one for each action (default: synthetic motions)"
    add("--data", type=Path, nargs="+", metavar="FOLDER", help=data_help)
    test_help = "names of the files to test on, required with --data"
    add("--test", nargs="+", default=[], metavar="PATTERN", help=test_help)
    actions_help = f"actions to synthesise without --data, of {', '.join(ACTIONS)} (default: all)"
    add("--actions", nargs="+", choices=ACTIONS, default=ACTIONS, metavar="NAME", help=actions_help)
    minutes_help = "minutes of each synthetic action to train on, and to test on (default: 180)"
    add("--minutes", type=kinds.positive, default=180.0, help=minutes_help)
    add("--seed", type=kinds.whole_number, default=0, help="seed of all random numbers (default 0)")
    add("--quiet", action="store_true", help="show no progress")
    add_json_argument(parser)
    kinds.add_motion_arguments(parser)
    train_options.add_sequence_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read or synthesise the actions, train, measure and write."""
    from numpy_cae.experiments.sequences.sequential import sequential
    from numpy_cae.manifold import save_manifold

    if args.frames < 3:
        raise ValueError(f"--frames is {args.frames}, expected 3 or more")
    actions = _actions(args)
    args.output.mkdir(parents=True, exist_ok=True)
    results, manifolds = sequential(
        actions,
        train_options.sequence_schedule_of(args),
        args.seed,
        hidden=args.hidden,
        latent=args.latent,
        frames=args.frames,
        show_progress=not args.quiet,
    )
    tables = [result for result in results.values() if result.tables]
    claims = [claim.text() for result in tables for claim in result.claims]
    parts = [f"{result.title}\n\n{result.text()}" for result in tables] + ["\n".join(claims)]
    text = "\n\n".join(parts) + "\n"
    with atomic_write(args.output / "study.txt") as beside:
        beside.write_text(text, encoding="utf-8")
    for name, result in results.items():
        if result.figure:
            result.save_picture(args.output / f"{name}.png")
        if result.animation:
            result.save_gif(args.output / f"{name}.gif")
    for name, manifold in manifolds.items():
        save_manifold(manifold, args.output / f"{name}.npz")
    if args.json:
        print_json([result.data() for result in tables])
    else:
        print(text, end="")
    return 0


def _actions(args: argparse.Namespace) -> list[Action]:
    from numpy_cae.experiments.sequences.actions import read_action, synthetic_action

    if not args.data:
        return [
            synthetic_action(name, args.minutes, args.minutes, args.seed) for name in args.actions
        ]
    mapping = kinds.chosen_mapping(args)
    actions = [
        read_action(folder.resolve().name, [folder], args.test, mapping, args.unit)
        for folder in args.data
    ]
    for action in actions:
        if not (action.training and action.testing):
            which = "train" if action.testing else "test"
            raise ValueError(f"--test leaves nothing of {action.name} to {which}")
    return actions
