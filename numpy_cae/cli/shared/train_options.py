"""The options of `numpy-cae train` that describe a training, and the schedules that they make.

An option of a stage has the name of its field, such as `--rate`, with the prefix `--fine-` for fine
tuning. Both models have the same names. An option that is not given is no attribute of the parsed
arguments: the recipe or the default below applies.
"""

import argparse
from dataclasses import fields, replace
from typing import Any

import numpy as np

from numpy_cae.cli.shared import arguments
from numpy_cae.manifold.augmentation import damaged_chains
from numpy_cae.manifold.learning import HIDDEN, LATENT, RMS
from numpy_cae.motion import CLIP
from numpy_cae.motion.windows import LENGTH, OVERLAP
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

_COMMON = {
    "epochs": (arguments.whole_number, "number of epochs, of each layer where layers are trained"),
    "rate": (
        arguments.rate,
        "learning rate: of the first epoch, or the peak of a one-cycle schedule",
    ),
    "batch": (arguments.positive_number, "number of windows or clips in one step"),
    "decay": (arguments.rate, "factor applied to the learning rate after each epoch"),
    "momentum": (arguments.momentum, "momentum of gradient descent, from 0 to below 1"),
    "norm": (arguments.positive, "bound on the norm of the gradient"),
    "optimiser": (("sgd", "adam"), "optimiser, sgd or adam"),
    "rate-schedule": (("decay", "one-cycle"), "course of the learning rate, decay or one-cycle"),
}
_CONVOLUTIONAL = {
    "alpha": (arguments.rate, "weight of the sparsity term of equation 3"),
    "zeroed": (arguments.fraction, "share of input values set to zero; two: range to draw it from"),
    "rescaled": (None, "divide the corrupted input by 1 - the share of zeroed values"),
}
_SEQUENTIAL = {
    "steps": (arguments.positive_number, "number of steps in an epoch"),
    "weight": (arguments.rate, "weight λ of the sliced Wasserstein distance"),
    "directions": (arguments.positive_number, "number of directions of the sliced distance"),
    "posture": (arguments.rate, "standard deviation of the random postures added to clips"),
}
_SEQUENTIAL_NETWORK = {
    "hidden": (arguments.positive_number, "number of hidden units of each GRU", HIDDEN),
    "latent": (arguments.positive_number, "number of latent variables", LATENT),
    "frames": (
        arguments.positive_number,
        "number of frames in a clip, at 25 frames a second",
        CLIP,
    ),
}
_CONVOLUTIONAL_NETWORK = {
    "window": (arguments.positive_number, "number of frames in a window, at 30 a second", LENGTH),
    "overlap": (arguments.whole_number, "number of frames that successive windows share", OVERLAP),
    "filters": (arguments.positive_number, "number of filters of each layer", [64, 128, 256]),
    "taps": (arguments.odd_number, "number of frames that a filter covers, odd", 15),
    "bound": (arguments.bound, "absolute value at which the input of arctanh is clipped", 0.9),
    "rms": (arguments.positive, "root mean square that the features are scaled to", RMS),
}


def add_training_options(parser: argparse.ArgumentParser) -> None:
    """The options of both models; the few that people change are outside the advanced groups."""
    paper, sequence = RECIPES["paper"], SequenceSchedule()
    group: Any = parser
    for name, (kind, text) in _COMMON.items():
        if name == "decay":
            group = parser.add_argument_group("advanced")
        usual = f"{_field(paper.layer, name)}, sequential model {_field(sequence, name)}"
        _add(group, name, kind, f"{text} (recipe paper: {usual})")
    group = parser.add_argument_group("advanced, convolutional model")
    _add_all(group, _CONVOLUTIONAL_NETWORK)
    for name, (kind, text) in _CONVOLUTIONAL.items():
        _add(group, name, kind, f"{text} (recipe paper: {_field(paper.layer, name)})")
    for name, (kind, _) in {**_COMMON, **_CONVOLUTIONAL}.items():
        usual = _field(paper.fine_tuning, name)
        _add(group, f"fine-{name}", kind, f"--{name} for fine tuning (recipe paper: {usual})")
    group = parser.add_argument_group("advanced, sequential model")
    _add_all(group, _SEQUENTIAL_NETWORK | _SEQUENTIAL)


def add_sequence_options(parser: argparse.ArgumentParser) -> None:
    """The options of the sequential model alone, for `numpy-cae study`."""
    options = _SEQUENTIAL_NETWORK | _COMMON | _SEQUENTIAL
    _add_all(parser.add_argument_group("training"), options)


def _add_all(group: argparse._ArgumentGroup, options: dict[str, Any]) -> None:
    """Options with their own defaults or those of the sequential model's schedule."""
    for name, (kind, text, *default) in options.items():
        shown = default[0] if default else _field(SequenceSchedule(), name)
        _add(group, name, kind, f"{text} (default: {shown})")


def _add(group: Any, name: str, kind: Any, text: str) -> None:
    settings: dict[str, Any] = {"default": argparse.SUPPRESS, "help": text}
    if kind is None:
        settings["action"] = argparse.BooleanOptionalAction
    elif isinstance(kind, tuple):
        settings["choices"] = kind
    else:
        settings |= {"type": kind, "metavar": "N"}
    if name.endswith(("zeroed", "filters")):
        settings["nargs"] = "+"
    group.add_argument(f"--{name}", **settings)


def _field(stage: Stage | SequenceSchedule, option: str) -> Any:
    return getattr(stage, option.replace("-", "_"))


def require_options_of_model(args: argparse.Namespace) -> None:
    """Raise ValueError where an option of the other model is given."""
    others = {*_SEQUENTIAL, *_SEQUENTIAL_NETWORK}
    if args.model == "sequential":
        fine = {f"fine-{name}" for name in (*_COMMON, *_CONVOLUTIONAL)}
        others = {*_CONVOLUTIONAL, *_CONVOLUTIONAL_NETWORK, *fine}
        if args.recipe not in SEQUENCE_RECIPES:
            raise ValueError(f"--recipe {args.recipe} is for the convolutional model")
    for name in sorted(others):
        if hasattr(args, name.replace("-", "_")):
            raise ValueError(f"--{name} is not an option of the {args.model} model")


def network_of(args: argparse.Namespace, sequential: bool) -> dict[str, Any]:
    """The arguments of `learn_manifold` or `learn_sequences` that describe the network."""
    options = _SEQUENTIAL_NETWORK if sequential else _CONVOLUTIONAL_NETWORK
    return {name: getattr(args, name, default) for name, (_, _, default) in options.items()}


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
