"""The options of `train`, and of a study, that change a recipe or a network.

The Python functions `learn_manifold` and `learn_sequences` take every other setting of a training.
"""

import argparse
from dataclasses import replace
from typing import Any

from numpy_cae.cli.shared import arguments
from numpy_cae.manifold.learning import HIDDEN, LATENT
from numpy_cae.motion.clips import CLIP
from numpy_cae.motion.windows import LENGTH
from numpy_cae.training import RECIPES as TRAINING_RECIPES
from numpy_cae.training import SEQUENCE_RECIPES, Schedule, SequenceSchedule, Stage

_STARTER = Stage(
    epochs=50,
    rate=3e-4,
    alpha=0.0,
    batch=16,
    zeroed=(0.0, 0.3),
    optimiser="adam",
    rate_schedule="one-cycle",
    displacement=0.3,
    noise=0.02,
)
MIRRORED = ("starter",)
"""Recipes that learn from mirrored copies as well."""
RECIPES = TRAINING_RECIPES | {"starter": Schedule(layer=Stage(epochs=0), fine_tuning=_STARTER)}

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


def add_options(parser: argparse.ArgumentParser, title: str, options: dict[str, str]) -> None:
    """Add a group of options. The parsed value is None where an option is not given."""
    group = parser.add_argument_group(title)
    for name, text in options.items():
        number = arguments.rate if name == "rate" else arguments.positive_number
        count = "+" if name == "filters" else None
        group.add_argument(f"--{name}", type=number, nargs=count, metavar="N", help=text)


def given(args: argparse.Namespace, *names: str) -> dict[str, Any]:
    """Those of the named options that are given, with their values."""
    return {name: getattr(args, name) for name in names if getattr(args, name) is not None}


def require_options_of_model(args: argparse.Namespace) -> None:
    """Raise ValueError where an option or a recipe of the other model is given."""
    sequential = args.model == "sequential"
    for name in given(args, *(CONVOLUTIONAL if sequential else SEQUENTIAL)):
        raise ValueError(f"--{name} is not an option of the {args.model} model")
    if sequential and args.recipe not in SEQUENCE_RECIPES:
        raise ValueError(f"--recipe {args.recipe} is for the convolutional model")


def schedule_of(args: argparse.Namespace) -> Schedule:
    """The recipe with the options that are given."""
    schedule = RECIPES[args.recipe]
    changed = given(args, *COMMON)
    if schedule.layer.epochs:
        schedule = replace(schedule, layer=replace(schedule.layer, **changed))
        changed.pop("rate", None)
    return replace(schedule, fine_tuning=replace(schedule.fine_tuning, **changed))


def sequence_schedule_of(args: argparse.Namespace, recipe: str = "paper") -> SequenceSchedule:
    """The schedule of the sequential model that the recipe and the options describe."""
    return replace(SEQUENCE_RECIPES[recipe], **given(args, *COMMON, "steps"))
