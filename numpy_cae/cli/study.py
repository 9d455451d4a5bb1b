"""`numpy-cae study -o FOLDER`: every result of jang2018, trained for and measured."""

from __future__ import annotations

import argparse
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import train_sequential
from numpy_cae.cli.as_json import add_json_argument, print_json
from numpy_cae.experiments.sequences.actions import Action, read_action, synthetic_action
from numpy_cae.experiments.sequences.sequential import sequential
from numpy_cae.manifold import save_sequences

ACTIONS = ("walking", "waiting", "walking_dog")


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Actions in, tables and pictures out."""
    parser = subparsers.add_parser(
        "study",
        help="every result of jang2018, trained for and measured",
        description="Train jang2018's network on each action, with its regulariser and without, "
        "and write study.txt (each claim, our table, whether it held), figure 2 and samples as "
        "strips and GIFs, beside the models. Without --data the motions are made by data_synth.",
        epilog="example: numpy-cae study -o study; with motions of your own, a folder an action: "
        "numpy-cae study --data cmu/walking --test 'walking_5.txt' -o study",
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    add = parser.add_argument
    add("-o", "--output", type=Path, required=True, metavar="FOLDER", help="made if missing")
    add("--data", type=Path, nargs="+", metavar="FOLDER", help="motion files of one action each")
    add("--test", nargs="+", default=[], metavar="PATTERN", help="with --data: files kept out")
    add("--actions", nargs="+", choices=ACTIONS, default=list(ACTIONS), help="without --data")
    add(
        "--minutes",
        type=kinds.positive,
        default=180.0,
        help="to learn from, of each action, without --data; as many to test on",
    )
    add("--seed", type=kinds.whole_number, default=0, help="of everything drawn")
    add("--quiet", action="store_true", help="show no progress")
    add_json_argument(parser)
    kinds.add_motion_arguments(parser)
    train_sequential.add_arguments(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read or make, train, measure, write."""
    actions = _read(args) if args.data else [_made(name, args) for name in args.actions]
    args.output.mkdir(parents=True, exist_ok=True)
    result = sequential(
        actions,
        train_sequential.schedule_of(args),
        args.seed,
        args.hidden,
        args.latent,
        args.frames,
        show_progress=not args.quiet,
    )
    findings = "\n".join(finding.text() for finding in result.findings())
    text = f"{result.text()}\n\n{findings}\n"
    with atomic_write(args.output / "study.txt") as beside:
        beside.write_text(text, encoding="utf-8")
    result.save_pictures(args.output)
    for name, manifold in result.manifolds.items():
        save_sequences(manifold, args.output / f"{name}.npz")
    if args.json:
        print_json([_told(each) for each in result.tables])
    else:
        print(text, end="")
    return 0


def _told(result: object) -> dict:
    """A table: its claims, and the figures that they were weighed by."""
    return {
        "title": result.title,
        "claims": result.findings(),
        "rows": getattr(result, "rows", None),
        "text": result.text(),
    }


def _made(name: str, args: argparse.Namespace) -> Action:
    return synthetic_action(name, args.minutes, args.minutes, args.seed)


def _read(args: argparse.Namespace) -> list[Action]:
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
