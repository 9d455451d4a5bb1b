"""Train jang2018's network on each action, with its regulariser and without (λ = 0). Write
study.html (tables, pictures, motions, and for each claim of the paper whether it is confirmed), the
same as study.txt, figure 2 and samples as files of their own, and the models. Without --data the
motions are made by data_synth.

examples:
  numpy-cae study -o study
  numpy-cae study --data cmu/walking --test 'walking_5.txt' -o study
"""

import argparse
import sys
import time

from numpy_cae.cli.shared import arguments, train_options
from numpy_cae.cli.shared.output import write_texts
from numpy_cae.experiments.page import page
from numpy_cae.experiments.sequences.sequential import sequential
from numpy_cae.experiments.sequences.study import Action, read_action, synthetic_action
from numpy_cae.training import ProgressPrinter
from numpy_cae.viz import save_figure, save_viewer

SUMMARY = (
    "What is measured: whether the network of Jang and Lee (2018), which writes a clip in a few "
    "numbers, reconstructs clips and draws new ones as the paper says. On what: clips that nothing "
    "was trained on. Against what: principal components of as many numbers, the mean pose, the "
    "first pose, and the same network without its regulariser. The best value of a column is bold."
)
ACTIONS = ("walking", "waiting", "walking_dog")
INTERVAL = 5.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The motions, the folder and the training."""
    add = parser.add_argument
    output = "folder for all results, created if it does not exist"
    add("-o", "--output", **arguments.FOLDER, required=True, help=output)
    data = "folders of motion files, one for each action (default: synthetic motions)"
    add("--data", **arguments.FOLDERS, help=data)
    add("--test", **arguments.PATTERNS, help="names of the files to test on, required with --data")
    actions = f"actions to synthesise without --data, of {', '.join(ACTIONS)} (default: all)"
    add("--actions", nargs="+", choices=ACTIONS, default=ACTIONS, metavar="NAME", help=actions)
    minutes = "minutes of each synthetic action to train on, and to test on (default: 30)"
    add("--minutes", type=arguments.positive, default=30.0, help=minutes)
    arguments.add_shared(parser, "seed quiet mapping unit up floor")
    options = train_options.COMMON | train_options.SEQUENTIAL
    train_options.add_options(parser, "training", options)


def run(args: argparse.Namespace) -> int:
    """Read or synthesise the actions, train, measure and write."""
    network = train_options.given(args, "hidden", "latent", "frames")
    if network.get("frames", 3) < 3:
        raise ValueError(f"--frames is {args.frames}, expected 3 or more")
    schedule = train_options.sequence_schedule_of(args, "fast")
    actions = _actions(args)
    args.output.mkdir(parents=True, exist_ok=True)
    report = None if args.quiet else ProgressPrinter
    results, manifolds = sequential(actions, schedule, args.seed, report=report, **network)
    tables = [result for result in results.values() if result.tables]
    claims = [claim.text() for result in tables for claim in result.claims]
    parts = [f"{result.title}\n\n{result.text()}" for result in tables] + ["\n".join(claims)]
    text = "\n\n".join(parts) + "\n"
    names = ", ".join(action.name for action in actions)
    settings = {"actions": names, "seed": str(args.seed), "training": str(schedule)}
    html = page(results, settings, "Latent Motion Manifold with Sequential Auto-Encoders", SUMMARY)
    write_texts(args.output, {"study.txt": text, "study.html": html})
    for name, result in results.items():
        if result.figure:
            save_figure(result.figure(), args.output / f"{name}.png")
        if moving := result.animation:
            save_viewer(moving.actors, args.output / f"{name}.html", moving.rate)
    for name, manifold in manifolds.items():
        manifold.save(args.output / f"{name}.npz")
    print(text, end="")
    return 0


def _actions(args: argparse.Namespace) -> list[Action]:
    if not args.data:
        return [_synthesised(name, args) for name in args.actions]
    reading = arguments.reading(args)
    actions = [
        read_action(folder.resolve().name, [folder], args.test, *reading) for folder in args.data
    ]
    for action in actions:
        if not (action.training and action.testing):
            which = "train" if action.testing else "test"
            raise ValueError(f"--test leaves nothing of {action.name} to {which}")
    return actions


def _synthesised(name: str, args: argparse.Namespace) -> Action:
    """An action; a line to standard error counts its takes every `INTERVAL` seconds."""
    printed = -INTERVAL

    def report(made: int, count: int) -> None:
        nonlocal printed
        if not args.quiet and time.monotonic() - printed > INTERVAL:
            print(f"{name}: {made} of {count} takes made", file=sys.stderr, flush=True)
            printed = time.monotonic()

    return synthetic_action(name, args.minutes, args.seed, report)
