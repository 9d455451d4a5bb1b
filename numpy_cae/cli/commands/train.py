"""Learn a manifold from every motion file (.bvh, .amc, exponential-map .txt) in one or more
folders. A recipe is a set of training options: `paper` is the training of holden2015, `fast` trains
all layers at once with Adam, `best` does the same for three times as many epochs, `starter` made
the model of the package. Other options replace those of the recipe. Only one training at a time can
write a model file: a second one is refused as soon as the first has saved its state in
MODEL.checkpoint.npz.

example: numpy-cae train motions/ -o model.npz --test '*_005.bvh' --recipe best
"""

import argparse
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy_cae.cli.shared import arguments, train_options
from numpy_cae.cli.shared.output import note, print_json, require_place
from numpy_cae.cli.shared.takes import minutes_of, read_takes
from numpy_cae.experiments.material import is_test, unlabelled
from numpy_cae.experiments.result import Result
from numpy_cae.manifold import learn_manifold, learn_sequences, save_manifold
from numpy_cae.motion import ANGLE_RATE, find_motion_files
from numpy_cae.training import Checkpoint, ProgressPrinter


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the model, the recipe and every option of a training."""
    add = parser.add_argument
    add(
        "folders",
        **arguments.FOLDERS,
        help="folders of motion files, searched with their subfolders",
    )
    add("-o", "--output", type=Path, required=True, help="model file to write, .npz")
    add(
        "--test",
        **arguments.PATTERNS,
        help="names of the files to test on; they are not trained on",
    )
    picture = "picture to write: a test take repaired, or samples of the sequential model"
    add("--picture", type=Path, metavar="PNG", help=picture)
    models = ("convolutional", "sequential")
    model = f"network of holden2015 or, for one action, of jang2018 (default: {models[0]})"
    add("--model", choices=models, default=models[0], help=model)
    add("--recipe", choices=train_options.RECIPES, default="paper", help="recipe (default: paper)")
    engine = "code that computes the gradients: `fast`, or the definitions in `ops` (default: fast)"
    add("--engine", choices=("fast", "ops"), default="fast", help=engine)
    resume = "continue an interrupted run from MODEL.checkpoint.npz; the result is identical"
    add("--resume", **arguments.FLAG, help=resume)
    arguments.add_shared(parser, "seed quiet json mapping unit up floor")
    train_options.add_training_options(parser)
    add = parser.add_argument_group("advanced, files").add_argument
    often = "seconds between saved states; a state is also saved after each epoch (default: 60)"
    add("--checkpoint", type=arguments.rate, default=60.0, metavar="SECONDS", help=often)
    add(
        "--strict",
        **arguments.FLAG,
        help="stop at a file that cannot be used instead of skipping it",
    )


def run(args: argparse.Namespace) -> int:
    """Read, train, save, measure and draw."""
    train_options.require_options_of_model(args)
    if args.picture and not args.test:
        raise ValueError("--picture draws a test take: name the test takes with --test")
    require_place(args.output)
    if args.resume and args.output.exists() and not state_of(args.output).exists():
        return _print(args, "is complete, there is nothing to continue")
    learn = _learn_sequences if args.model == "sequential" else _learn_windows
    with one_run(args.output, args.checkpoint, args.resume) as checkpoint:
        learned = learn(args, checkpoint)
        learned.manifold.settings["test"] = args.test
        save_manifold(learned.manifold, args.output, half=args.recipe == "starter")
        checkpoint.remove()
    text = f"learned from {learned.source}"
    table = None
    try:
        if args.test:
            table = learned.measure()
            text += f"\n\n{table.text()}"
        else:
            text += "; no error is measured without --test"
        if args.picture:
            learned.draw().save_picture(args.picture)
            text += f"\n\n{args.picture}: written"
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"{args.output} is complete, but not measured") from None
    return _print(args, text, learned.manifold.settings, table.data() if table else None)


def _print(
    args: argparse.Namespace, text: str, settings: dict | None = None, test: dict | None = None
) -> int:
    if args.json:
        print_json({"model": args.output, "settings": settings, "test": test})
    else:
        print(f"{args.output}: {text}")
    return 0


@dataclass(frozen=True)
class Learned:
    """A trained manifold, and functions that test it."""

    manifold: Any
    source: str  # what it was learned from, in words
    measure: Callable[[], Result]  # its errors on the test takes
    draw: Callable[[], Result]  # a picture of a test take, or of samples


def _learn_windows(args: argparse.Namespace, checkpoint: Checkpoint) -> Learned:
    """Learn the convolutional model from every file in the folders."""
    from numpy_cae.experiments.repair import half_removed

    files = {folder: find_motion_files(folder) for folder in args.folders}
    paths = [path for group in files.values() for path in group]
    training, testing = read_takes(paths, *arguments.reading(args), args.test, args.strict)
    manifold = learn_manifold(
        training,
        train_options.schedule_of(args),
        args.seed,
        mirror=args.recipe in train_options.MIRRORED,
        report=None if args.quiet else ProgressPrinter(),
        checkpoint=checkpoint,
        engine=args.engine,
        **train_options.network_of(args, args.model),
    )
    manifold.settings["folders"] = [
        {"name": folder.resolve().name, "files": len(group)}
        | {"test": sum(is_test(path, args.test) for path in group)}
        for folder, group in files.items()
    ]
    material = unlabelled(training, testing)
    return Learned(
        manifold,
        f"{manifold.settings['windows']} windows",
        lambda: half_removed.run(manifold, material),
        lambda: half_removed.figure_1(manifold, material),
    )


def _learn_sequences(args: argparse.Namespace, checkpoint: Checkpoint) -> Learned:
    """Learn the sequential model of one action from every file in the folders."""
    from numpy_cae.experiments.sequences.samples import figure_3
    from numpy_cae.experiments.sequences.sequential import reconstruction
    from numpy_cae.experiments.sequences.study import Study, read_action

    name, network = args.folders[0].resolve().name, train_options.network_of(args, args.model)
    action = read_action(name, args.folders, args.test, *arguments.reading(args), args.strict)
    if args.test and not action.testing:
        raise ValueError(f"no file matches {' '.join(args.test)}, none is left to test")
    if not action.training:
        raise ValueError(f"every file matches {' '.join(args.test)}, none is left to train")
    count, minutes = len(action.training), minutes_of(action.training, ANGLE_RATE)
    note(f"{count} motions to train on ({minutes}), {len(action.testing)} to test")
    manifold = learn_sequences(
        action.training,
        train_options.sequence_schedule_of(args),
        args.seed,
        report=None if args.quiet else ProgressPrinter(),
        checkpoint=checkpoint,
        engine=args.engine,
        **network,
    )
    study = Study(action, manifold)
    return Learned(
        manifold,
        f"clips of {network['frames']} frames of {count} motions",
        lambda: reconstruction([study]),
        lambda: figure_3(study),
    )


@contextmanager
def one_run(output: Path, seconds: float, resume: bool) -> Iterator[Checkpoint]:
    """Yield the checkpoint of the run that writes `output`.

    Raises CheckpointError if a run was interrupted, or is still running, and `resume` is False.
    """
    checkpoint = Checkpoint(state_of(output), seconds, resume)
    with _stopped_by_sigterm():
        checkpoint.require_none_unless_resumed()
        try:
            yield checkpoint
        except KeyboardInterrupt:
            advice = "; continue with --resume" if checkpoint.path.exists() else ""
            raise KeyboardInterrupt(f"{checkpoint.status()}{advice}") from None


def state_of(output: Path) -> Path:
    """The file in which the state of a run is saved."""
    return output.with_name(f"{output.stem}.checkpoint.npz")


@contextmanager
def _stopped_by_sigterm() -> Iterator[None]:
    """Let SIGTERM end training as Ctrl-C does: with a message, without half-written files."""
    try:
        before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    except ValueError:  # signals can only be handled in the main thread
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
