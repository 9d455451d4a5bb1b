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
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from numpy_cae import training, viz
from numpy_cae.atomic_write import require_free
from numpy_cae.cli.shared import arguments
from numpy_cae.cli.shared.files import read_bodies, read_usable, split_for_test
from numpy_cae.evaluation.tables import NOTE, compare_reconstructions, compare_repairs
from numpy_cae.manifold.augmentation import FileDamage, mirror
from numpy_cae.manifold.learning import HIDDEN, LATENT, learn_manifold, learn_sequences
from numpy_cae.mocap.load import find_motion_files, load_angles, matches_any
from numpy_cae.motion import ANGLE_RATE, CLIP, LENGTH, RATE
from numpy_cae.training.schedule import change_schedule

_BEST = training.RECIPES["best"]
_STARTER = replace(
    _BEST.fine_tuning,
    epochs=50,
    rate=3e-4,
    zeroed=(0.0, 0.3),
    rescaled=False,
    norm=None,
    damage=FileDamage(displacement=0.3, noise=0.02),
)
RECIPES = training.RECIPES | {"starter": replace(_BEST, fine_tuning=_STARTER)}

COMMON = {
    "epochs": "number of epochs; with recipe paper of each layer, and of fine tuning",
    "rate": "learning rate of the first epoch, or the peak with recipes fast and best; with recipe "
    "paper of the layers, not of fine tuning",
    "batch": "number of windows or clips in one step",
}
CONVOLUTIONAL = {
    "window": f"number of frames in a window, at 30 a second (default: {LENGTH})",
    "filters": "number of filters of each layer (default: 64 128 256)",
}
SEQUENTIAL = {
    "steps": "number of steps in an epoch",
    "hidden": f"number of hidden units of each GRU (default: {HIDDEN})",
    "latent": f"number of latent variables (default: {LATENT})",
    "frames": f"number of frames in a clip, at 25 a second (default: {CLIP})",
}
"""Help of each option, of both models and of one; the recipe sets what has no default here."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the model, the recipe and what replaces parts of it."""
    add = parser.add_argument
    add("folders", **arguments.FOLDERS, help="folders of motion files, searched with subfolders")
    add("-o", "--output", type=Path, required=True, help="model file to write, .npz")
    add("--test", **arguments.PATTERNS, help="names of the files to test on and not to train on")
    models = ("convolutional", "sequential")
    model = f"network of holden2015 or, for one action, of jang2018 (default: {models[0]})"
    add("--model", choices=models, default=models[0], help=model)
    add("--recipe", choices=RECIPES, default="paper", help="recipe (default: paper)")
    engine = "code that computes the gradients: `fast`, or the definitions in `ops` (default: fast)"
    add("--engine", choices=("fast", "ops"), default="fast", help=engine)
    add("--resume", **arguments.FLAG, help="continue an interrupted run; the result is identical")
    arguments.add_shared(parser, "overwrite seed quiet mapping unit up floor")
    add_options(parser, "training", COMMON)
    add_options(parser, "convolutional model", CONVOLUTIONAL)
    add_options(parser, "sequential model", SEQUENTIAL)


def run(args: argparse.Namespace) -> int:
    """Read, train, save, measure and draw."""
    require_options_of_model(args)
    if args.output.suffix.lower() != ".npz":
        raise ValueError(f"{args.output}: expected the name of a model file, which ends in .npz")
    state = args.output.with_name(f"{args.output.stem}.checkpoint.npz")
    checkpoint = training.Checkpoint(state, resume=args.resume)
    if args.resume and args.output.exists() and not state.exists():
        print(f"{args.output}: is complete, there is nothing to continue")
        return 0
    picture = args.output.with_suffix(".png")
    require_free(args.output)
    require_free(picture)
    learn = _learn_sequences if args.model == "sequential" else _learn_windows
    # A training that diverges ends with its rate and what to do, without NumPy's warnings before.
    with interruptible(checkpoint), np.errstate(over="ignore", invalid="ignore"):
        settings = {
            "seed": args.seed,
            "report": None if args.quiet else training.ProgressPrinter(),
            "checkpoint": checkpoint,
            "engine": args.engine,
        }
        manifold, source, measure = learn(args, settings)
        manifold.settings["test"] = args.test
        if args.recipe == "starter":
            manifold.save(args.output, half=True)
        else:
            manifold.save(args.output)
        checkpoint.path.unlink(missing_ok=True)
    viz.save_figure(viz.losses_figure(manifold.settings["losses"]), picture)
    hint = "" if args.test else "; no error is measured without --test"
    print(f"{picture}: loss by epoch\n{args.output}: learned from {source}{hint}")
    if args.test:
        print(f"\n{measure()}")
    return 0


class TrainedModel(NamedTuple):
    """What `train` saves, says and measures."""

    manifold: Any
    source: str  # what it was learned from, in words
    measure: Callable[[], str]  # returns its errors on the test takes as text


def _learn_windows(args: argparse.Namespace, settings: dict[str, Any]) -> TrainedModel:
    """Learn the convolutional model from every file in the folders."""
    files = {folder: find_motion_files(folder) for folder in args.folders}
    paths = list(chain.from_iterable(files.values()))
    takes, testing = split_for_test(read_bodies(args, paths), args.test, RATE)
    learned: Iterable[np.ndarray] = takes
    if args.recipe == "starter":
        learned = [*takes, *(mirror(take) for take in takes)]
    elif not args.test:  # nothing is measured on them later
        learned = _take_out(takes)
    settings |= {"testing": testing} | chosen_options(args, *CONVOLUTIONAL)
    manifold = learn_manifold(learned, schedule_of(args), **settings)
    manifold.settings["folders"] = [
        _count_files(folder, group, args.test) for folder, group in files.items()
    ]
    source = f"{manifold.settings['windows']} windows"

    def measure() -> str:
        return f"{compare_repairs(manifold, takes, testing).text()}\n\n{NOTE}"

    return TrainedModel(manifold, source, measure)


def _take_out(takes: list[np.ndarray]) -> Iterator[np.ndarray]:
    """The takes, which the list then no longer holds in memory."""
    while takes:
        yield takes.pop(0)


def _count_files(folder: Path, paths: list[Path], test: list[str]) -> dict[str, Any]:
    """The name of a folder, and the numbers of its files and of those to test on."""
    tested = sum(matches_any(path, test) for path in paths)
    return {"name": folder.resolve().name, "files": len(paths), "test": tested}


def _learn_sequences(args: argparse.Namespace, settings: dict[str, Any]) -> TrainedModel:
    """Learn the sequential model of one action from every file in the folders."""
    paths = list(chain.from_iterable(find_motion_files(folder) for folder in args.folders))
    sequences = read_usable(paths, partial(load_angles, **arguments.reading(args)))
    takes, testing = split_for_test(sequences, args.test, ANGLE_RATE)
    schedule = sequence_schedule_of(args, args.recipe)
    settings |= chosen_options(args, "hidden", "latent", "frames")
    manifold = learn_sequences(takes, schedule, **settings)
    source = f"clips of {manifold.frames} frames of {len(takes)} motions"
    name = args.folders[0].resolve().name

    def measure() -> str:
        return compare_reconstructions(name, manifold, takes, testing).text()

    return TrainedModel(manifold, source, measure)


@contextmanager
def interruptible(checkpoint: training.Checkpoint) -> Iterator[None]:
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


def add_options(parser: argparse.ArgumentParser, title: str, options: dict[str, str]) -> None:
    """Add a group of options. The parsed value is None where an option is not given."""
    group = parser.add_argument_group(title)
    for name, text in options.items():
        number = arguments.rate if name == "rate" else arguments.positive_number
        count = "+" if name == "filters" else None
        group.add_argument(f"--{name}", type=number, nargs=count, metavar="N", help=text)


def chosen_options(args: argparse.Namespace, *names: str) -> dict[str, Any]:
    """Those of the named options that the user has set, with their values."""
    return {name: getattr(args, name) for name in names if getattr(args, name) is not None}


def require_options_of_model(args: argparse.Namespace) -> None:
    """Raise ValueError where an option or a recipe of the other model is given."""
    is_sequential = args.model == "sequential"
    excluded = CONVOLUTIONAL if is_sequential else SEQUENTIAL
    for name in chosen_options(args, *excluded):
        raise ValueError(f"--{name} is not an option of the {args.model} model")
    if is_sequential and args.recipe not in training.SEQUENCE_RECIPES:
        raise ValueError(f"--recipe {args.recipe} is for the convolutional model")


def schedule_of(args: argparse.Namespace) -> training.Schedule:
    """The recipe with the options that are given."""
    return change_schedule(RECIPES[args.recipe], args.epochs, args.rate, args.batch)


def sequence_schedule_of(args: argparse.Namespace, recipe: str) -> training.SequenceSchedule:
    """The schedule of the sequential model that the recipe and the options describe."""
    return replace(training.SEQUENCE_RECIPES[recipe], **chosen_options(args, *COMMON, "steps"))
