"""The options of `numpy-cae train` that describe a training, and the schedules that they make.

An option of a stage has the name of its field, such as `--rate`, with the prefix `--fine-` for fine
tuning. Both models have the same names. An option that is not given is no attribute of the parsed
arguments: the recipe or the default below applies.
"""

import argparse
from dataclasses import fields, replace
from inspect import signature
from typing import Any

import numpy as np

from numpy_cae.cli.shared import arguments
from numpy_cae.manifold.augmentation import damaged_chains
from numpy_cae.manifold.learning import learn_manifold, learn_sequences
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
    chains=damaged_chains(),
    displacement=0.3,
    noise=0.02,
)
MIRRORED = ("starter",)
"""Recipes that learn from mirrored copies as well."""
RECIPES = TRAINING_RECIPES | {"starter": Schedule(layer=Stage(epochs=0), fine_tuning=_STARTER)}

HELP = {
    "epochs": "number of epochs, of each layer where layers are trained",
    "rate": "learning rate: of the first epoch, or the peak with the recipes fast and best",
    "batch": "number of windows or clips in one step",
    "decay": "factor applied to the learning rate after each epoch",
    "momentum": "momentum of gradient descent, from 0 to below 1",
    "norm": "bound on the norm of the gradient",
    "alpha": "weight of the sparsity term of equation 3",
    "zeroed": "share of input values set to zero; two: range to draw it from",
    "rescaled": "divide the corrupted input by 1 - the share of values set to zero",
    "steps": "number of steps in an epoch",
    "weight": "weight λ of the sliced Wasserstein distance",
    "directions": "number of directions of the sliced distance",
    "posture": "standard deviation of the random postures added to clips",
    "window": "number of frames in a window, at 30 a second",
    "overlap": "number of frames that successive windows share",
    "filters": "number of filters of each layer",
    "taps": "number of frames that a filter covers, odd",
    "bound": "absolute value at which the input of arctanh is clipped",
    "rms": "root mean square that the features are scaled to",
    "hidden": "number of hidden units of each GRU",
    "latent": "number of latent variables",
    "frames": "number of frames in a clip, at 25 a second",
}
COMMON = ("epochs", "rate", "batch", "decay", "momentum", "norm")
CONVOLUTIONAL = ("alpha", "zeroed", "rescaled")
SEQUENTIAL = ("steps", "weight", "directions", "posture")
NETWORKS = {
    "convolutional": ("window", "overlap", "filters", "taps", "bound", "rms"),
    "sequential": ("hidden", "latent", "frames"),
}
"""The arguments of `learn_manifold` and of `learn_sequences` that describe the network."""
_TYPES = {
    "epochs": arguments.whole_number,
    "momentum": arguments.momentum,
    "norm": arguments.positive,
    "zeroed": arguments.fraction,
    "overlap": arguments.whole_number,
    "filters": arguments.positive_number,
    "taps": arguments.odd_number,
    "bound": arguments.bound,
    "rms": arguments.positive,
}
"""Types of values. An option without a type here takes a positive whole number if its default is a
whole number, otherwise a rate."""


def add_training_options(parser: argparse.ArgumentParser) -> None:
    """The options of both models; the few that people change are outside the advanced groups."""
    paper, sequence = Schedule(), SequenceSchedule()
    group: Any = parser
    for name in COMMON:
        if name == "decay":
            group = parser.add_argument_group("advanced")
        usual = getattr(paper.layer, name)
        shown = f"recipe paper: {usual}, sequential model {getattr(sequence, name)}"
        _add(group, name, usual, f"{HELP[name]} ({shown})")
    group = parser.add_argument_group("advanced, convolutional model")
    for name, value in _network("convolutional").items():
        _add(group, name, value, f"{HELP[name]} (default: {value})")
    for name in CONVOLUTIONAL:
        value = getattr(paper.layer, name)
        _add(group, name, value, f"{HELP[name]} (recipe paper: {value})")
    for name in (*COMMON, *CONVOLUTIONAL):
        value = getattr(paper.fine_tuning, name)
        text = f"--{name} for fine tuning (recipe paper: {value})"
        _add(group, name, value, text, "fine-")
    _add_sequential(parser.add_argument_group("advanced, sequential model"), SEQUENTIAL)


def add_sequence_options(parser: argparse.ArgumentParser) -> None:
    """The options of the sequential model alone, for `numpy-cae study`."""
    _add_sequential(parser.add_argument_group("training"), (*COMMON, *SEQUENTIAL))


def _add_sequential(group: argparse._ArgumentGroup, names: tuple[str, ...]) -> None:
    values = {name: getattr(SequenceSchedule(), name) for name in names}
    for name, value in (_network("sequential") | values).items():
        _add(group, name, value, f"{HELP[name]} (default: {value})")


def _add(group: Any, name: str, default: Any, text: str, prefix: str = "") -> None:
    """Add an option that is no attribute of the parsed arguments where it is not given."""
    settings: dict[str, Any] = {"default": argparse.SUPPRESS, "help": text}
    if isinstance(default, bool):
        settings["action"] = argparse.BooleanOptionalAction
    else:
        usual = arguments.positive_number if isinstance(default, int) else arguments.rate
        settings |= {"type": _TYPES.get(name, usual), "metavar": "N"}
    if name in ("zeroed", "filters"):
        settings["nargs"] = "+"
    group.add_argument(f"--{prefix}{name}", **settings)


def _network(model: str) -> dict[str, Any]:
    """The network's options with the defaults of the function that learns it."""
    learn = learn_sequences if model == "sequential" else learn_manifold
    return {name: signature(learn).parameters[name].default for name in NETWORKS[model]}


def require_options_of_model(args: argparse.Namespace) -> None:
    """Raise ValueError where an option of the other model is given."""
    others = {*SEQUENTIAL, *NETWORKS["sequential"]}
    if args.model == "sequential":
        fine = {f"fine-{name}" for name in (*COMMON, *CONVOLUTIONAL)}
        others = {*CONVOLUTIONAL, *NETWORKS["convolutional"], *fine}
        if args.recipe not in SEQUENCE_RECIPES:
            raise ValueError(f"--recipe {args.recipe} is for the convolutional model")
    for name in sorted(others):
        if hasattr(args, name.replace("-", "_")):
            raise ValueError(f"--{name} is not an option of the {args.model} model")


def network_of(args: argparse.Namespace, model: str) -> dict[str, Any]:
    """The arguments of `learn_manifold` or `learn_sequences` that describe the network."""
    return {name: getattr(args, name, default) for name, default in _network(model).items()}


def schedule_of(args: argparse.Namespace) -> Schedule:
    """The recipe with the options that are given; end to end, those of a layer are for all."""
    layer, fine_tuning = RECIPES[args.recipe].layer, RECIPES[args.recipe].fine_tuning
    if layer.epochs == 0:
        fine_tuning = _changed(fine_tuning, args, "")
    else:
        layer = _changed(layer, args, "")
    return Schedule(layer, _changed(fine_tuning, args, "fine_"))


def sequence_schedule_of(args: argparse.Namespace) -> SequenceSchedule:
    """The schedule of the sequential model that the recipe and the options describe."""
    return _changed(SEQUENCE_RECIPES[getattr(args, "recipe", "paper")], args, "")


def _changed(stage: Any, args: argparse.Namespace, prefix: str) -> Any:
    """The stage with the fields for which an option is given."""
    names = [field.name for field in fields(stage) if hasattr(args, prefix + field.name)]
    given = {name: getattr(args, prefix + name) for name in names}
    if "zeroed" in given:
        shares = given["zeroed"]
        if len(shares) > 2 or shares != sorted(shares):
            option = f"--{prefix}zeroed".replace("_", "-")
            raise ValueError(f"{option} takes one share, or the lowest and the highest")
        given["zeroed"] = tuple(shares) if len(shares) == 2 else shares[0]
    changed = replace(stage, **given)
    if isinstance(stage, Stage) and changed.rescaled and np.max(changed.zeroed) == 1:
        raise ValueError("rescaling divides by 1 - the zeroed share, which must stay below 1")
    return changed
