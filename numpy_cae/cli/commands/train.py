"""Learn a manifold from every motion file (.bvh, .amc, exponential-map .txt) in one or more
folders. A recipe is a set of training options: paper is that of holden2015, fast trains all layers
at once with Adam, best does so for three times as many epochs, starter is that of the model in the
package. Options given beside it replace its own. Train into one model file once at a time: a second
training is refused as soon as the first has saved its state in MODEL.checkpoint.npz.

example: numpy-cae train motions/ -o model.npz --test '*_005.bvh' --recipe best
"""

import argparse
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from numpy_cae.cli.shared import arguments
from numpy_cae.cli.shared import train_options as options
from numpy_cae.cli.shared.output import note, print_json, require_place
from numpy_cae.cli.shared.takes import minutes_of, read_takes
from numpy_cae.experiments.material import is_test, unlabelled
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
    add("--test", **arguments.PATTERNS, help="names of files to test on, which are not trained on")
    picture = "picture to write: figure 1 of a test take, or samples of the sequential model"
    add("--picture", type=Path, metavar="PNG", help=picture)
    models = ("convolutional", "sequential")
    model = f"network of holden2015 or, for one action, of jang2018 (default: {models[0]})"
    add("--model", choices=models, default=models[0], help=model)
    add("--recipe", choices=options.RECIPES, default="paper", help="recipe (default: paper)")
    engine = "code that computes the gradients: fast, or the definitions in ops (default: fast)"
    add("--engine", choices=("fast", "ops"), default="fast", help=engine)
    resume = "continue an interrupted run from MODEL.checkpoint.npz; the result is identical"
    add("--resume", **arguments.FLAG, help=resume)
    arguments.add_shared(parser, "seed quiet json mapping unit up floor")
    options.add_training_options(parser)
    add = parser.add_argument_group("advanced, files").add_argument
    often = "seconds between two saved states within an epoch, also saved at its end (default: 60)"
    add("--checkpoint", type=arguments.rate, default=60.0, metavar="SECONDS", help=often)
    add("--strict", **arguments.FLAG, help="stop at a file that cannot be used, not skip it")


def run(args: argparse.Namespace) -> int:
    """Read, train, save, measure and draw."""
    options.require_options_of_model(args)
    if args.picture and not args.test:
        raise ValueError("--picture draws a test take: name the test takes with --test")
    require_place(args.output)
    if args.resume and args.output.exists() and not state_of(args.output).exists():
        return _print(args, "is complete, there is nothing to continue")
    with one_run(args.output, args.checkpoint, args.resume) as checkpoint:
        sequential = args.model == "sequential"
        learn = _learn_sequences if sequential else _learn_windows
        report = None if args.quiet else ProgressPrinter()
        how = {"report": report, "checkpoint": checkpoint, "engine": args.engine}
        manifold, summary, measure = learn(args, options.network_of(args, sequential) | how)
        manifold.settings["test"] = args.test
        save_manifold(manifold, args.output, half=args.recipe == "starter")
        checkpoint.remove()
    try:
        table, figure = measure() if args.test else (None, None)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"{args.output} is complete, but not measured") from None
    if figure:
        figure.save_picture(args.picture)
    text = f"learned from {summary}"
    text += f"\n\n{table.text()}" if table else "; no error is measured without --test"
    text += f"\n\n{args.picture}: written" if figure else ""
    return _print(args, text, manifold.settings, table.data() if table else None)


def _print(
    args: argparse.Namespace, text: str, settings: dict | None = None, test: dict | None = None
) -> int:
    if args.json:
        print_json({"model": args.output, "settings": settings, "test": test})
    else:
        print(f"{args.output}: {text}")
    return 0


Learned = tuple[Any, str, Callable[[], tuple]]
"""A manifold, what it was learned from, and a function that measures and draws it on test files."""


def _learn_windows(args: argparse.Namespace, how: dict[str, Any]) -> Learned:
    schedule = options.schedule_of(args)
    found = {folder: find_motion_files(folder) for folder in args.folders}
    paths = [path for some in found.values() for path in some]
    reading = arguments.reading(args)
    training, testing = read_takes(paths, *reading, args.test, args.strict)
    mirror = args.recipe in options.MIRRORED
    manifold = learn_manifold(training, schedule, args.seed, mirror=mirror, **how)
    manifold.settings["folders"] = [
        {"name": folder.resolve().name, "files": len(files)}
        | {"test": sum(is_test(path, args.test) for path in files)}
        for folder, files in found.items()
    ]

    def measure() -> tuple:
        from numpy_cae.experiments.repair import half_removed

        material = unlabelled(training, testing)
        figure = half_removed.figure_1(manifold, material) if args.picture else None
        return half_removed.run(manifold, material), figure

    return manifold, f"{manifold.settings['windows']} windows", measure


def _learn_sequences(args: argparse.Namespace, how: dict[str, Any]) -> Learned:
    from numpy_cae.experiments.sequences.study import read_action

    schedule, name = options.sequence_schedule_of(args), args.folders[0].resolve().name
    reading = arguments.reading(args)
    action = read_action(name, args.folders, args.test, *reading, args.strict)
    if args.test and not action.testing:
        raise ValueError(f"no file matches {' '.join(args.test)}, none is left to test")
    if not action.training:
        raise ValueError(f"every file matches {' '.join(args.test)}, none is left to train")
    count, tests = len(action.training), len(action.testing)
    minutes = minutes_of(action.training, ANGLE_RATE)
    note(f"{count} motions to train on ({minutes}), {tests} to test")
    manifold = learn_sequences(action.training, schedule, args.seed, **how)

    def measure() -> tuple:
        from numpy_cae.experiments.sequences.reconstruction import reconstruction
        from numpy_cae.experiments.sequences.samples import figure_3
        from numpy_cae.experiments.sequences.study import Study

        study = Study(action, manifold)
        return reconstruction([study]), figure_3(study) if args.picture else None

    return manifold, f"clips of {how['frames']} frames of {count} motions", measure


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
