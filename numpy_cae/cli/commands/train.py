"""Learn a manifold from every motion file (.bvh, .amc, exponential-map .txt) in one or more
folders. A recipe is a set of training options: `paper` is the training of holden2015, `fast` trains
all layers at once with Adam, `best` does so for three times as many epochs, `starter` made
the model of the package. Other options replace those of the recipe. Only one training at a time can
write a model file: a second one is refused as soon as the first has saved its state in
MODEL.checkpoint.npz.

examples, of which the first makes synthetic motions:
  python -m data_synth motions --minutes 20
  numpy-cae train motions/ -o model.npz --test '*_04.bvh' --recipe best
"""

import argparse
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

from numpy_cae import viz
from numpy_cae.atomic_write import require_place
from numpy_cae.cli.shared import arguments, train_options
from numpy_cae.cli.shared.takes import in_halves, read_takes, usable
from numpy_cae.evaluation.half_removed import NOTE, half_removed
from numpy_cae.evaluation.reconstruction import reconstruction
from numpy_cae.manifold import learn_manifold, learn_sequences
from numpy_cae.mocap import find_motion_files
from numpy_cae.mocap.load import is_test, load_angles
from numpy_cae.motion.angles import ANGLE_RATE
from numpy_cae.training import Checkpoint, ProgressPrinter


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the model, the recipe and what replaces parts of it."""
    add = parser.add_argument
    add("folders", **arguments.FOLDERS, help="folders of motion files, searched with subfolders")
    add("-o", "--output", type=Path, required=True, help="model file to write, .npz")
    add("--test", **arguments.PATTERNS, help="names of the files to test on and not to train on")
    models = ("convolutional", "sequential")
    model = f"network of holden2015 or, for one action, of jang2018 (default: {models[0]})"
    add("--model", choices=models, default=models[0], help=model)
    add("--recipe", choices=train_options.RECIPES, default="paper", help="recipe (default: paper)")
    engine = "code that computes the gradients: `fast`, or the definitions in `ops` (default: fast)"
    add("--engine", choices=("fast", "ops"), default="fast", help=engine)
    add("--resume", **arguments.FLAG, help="continue an interrupted run; the result is identical")
    arguments.add_shared(parser, "seed quiet mapping unit up floor")
    train_options.add_options(parser, "training", train_options.COMMON)
    train_options.add_options(parser, "convolutional model", train_options.CONVOLUTIONAL)
    train_options.add_options(parser, "sequential model", train_options.SEQUENTIAL)


def run(args: argparse.Namespace) -> int:
    """Read, train, save, measure and draw."""
    train_options.require_options_of_model(args)
    require_place(args.output)
    state = args.output.with_name(f"{args.output.stem}.checkpoint.npz")
    checkpoint = Checkpoint(state, resume=args.resume)
    if args.resume and args.output.exists() and not state.exists():
        print(f"{args.output}: is complete, there is nothing to continue")
        return 0
    learn = _learn_sequences if args.model == "sequential" else _learn_windows
    with interruptible(checkpoint):
        settings = {
            "seed": args.seed,
            "report": None if args.quiet else ProgressPrinter(),
            "checkpoint": checkpoint,
            "engine": args.engine,
        }
        manifold, source, measure = learn(args, settings)
        manifold.settings["test"] = args.test
        manifold.save(args.output, **{"half": True} if args.recipe == "starter" else {})
        checkpoint.remove()
    picture = args.output.with_suffix(".png")
    viz.save_figure(viz.losses_figure(manifold.settings["losses"]), picture)
    hint = "" if args.test else "; no error is measured without --test"
    print(f"{picture}: loss by epoch\n{args.output}: learned from {source}{hint}")
    if args.test:
        print(f"\n{measure()}")
    return 0


Learned = tuple[Any, str, Callable[[], str]]
"""A trained manifold, what it was learned from in words, and a function that measures its errors on
the test takes and returns them as text."""


def _learn_windows(args: argparse.Namespace, settings: dict[str, Any]) -> Learned:
    """Learn the convolutional model from every file in the folders."""
    files = {folder: find_motion_files(folder) for folder in args.folders}
    paths = [path for group in files.values() for path in group]
    training, testing = read_takes(paths, args.test, **arguments.reading(args))
    settings |= {"mirror": args.recipe in train_options.MIRRORED}
    settings |= {"testing": testing} | train_options.given(args, *train_options.CONVOLUTIONAL)
    manifold = learn_manifold(training, train_options.schedule_of(args), **settings)
    manifold.settings["folders"] = [
        {"name": folder.resolve().name, "files": len(group)}
        | {"test": sum(is_test(path, args.test) for path in group)}
        for folder, group in files.items()
    ]
    source = f"{manifold.settings['windows']} windows"
    return manifold, source, lambda: f"{half_removed(manifold, training, testing).text()}\n\n{NOTE}"


def _learn_sequences(args: argparse.Namespace, settings: dict[str, Any]) -> Learned:
    """Learn the sequential model of one action from every file in the folders."""
    paths = [path for folder in args.folders for path in find_motion_files(folder)]
    takes = usable(paths, partial(load_angles, **arguments.reading(args)))
    training, testing = in_halves(takes, args.test, ANGLE_RATE)
    schedule = train_options.sequence_schedule_of(args, args.recipe)
    settings |= train_options.given(args, "hidden", "latent", "frames")
    manifold = learn_sequences(training, schedule, **settings)
    source = f"clips of {manifold.frames} frames of {len(training)} motions"
    name = args.folders[0].resolve().name
    return manifold, source, lambda: reconstruction(name, manifold, training, testing).text()


@contextmanager
def interruptible(checkpoint: Checkpoint) -> Iterator[None]:
    """A block that Ctrl-C or SIGTERM ends with a message that says where the last state is.

    Raises CheckpointError if a run was interrupted, or is still running, and is not to be resumed.
    """
    with suppress(ValueError):  # signals can only be handled in the main thread
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # end as after Ctrl-C
    checkpoint.require_none_unless_resumed()
    try:
        yield
    except KeyboardInterrupt:
        advice = "; continue with --resume" if checkpoint.path.exists() else ""
        raise KeyboardInterrupt(f"{checkpoint.status()}{advice}") from None
