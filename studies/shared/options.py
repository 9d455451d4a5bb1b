"""The options of `python -m studies NAME`: each parameter of the study's `run` has its own.

`OPTIONS` has the parameters that many studies share; `Inputs` makes their values. Any other
parameter is an option of its name, with the type of its default.
"""

import argparse
import inspect
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cached_property
from glob import escape
from math import inf
from pathlib import Path
from typing import Any

from numpy_cae.manifold import MotionManifold, load_manifold, starter
from numpy_cae.manifold.learning import HIDDEN, LATENT
from numpy_cae.mocap import find_motion_files, read_mapping
from numpy_cae.mocap.load import matches_any
from numpy_cae.motion import CLIP
from numpy_cae.training import SEQUENCE_RECIPES, ProgressPrinter, SequenceSchedule
from studies.jang2018.actions import ACTIONS, Action, read_action, synthetic_action
from studies.shared.material import Material, read_material
from studies.shared.messages import note
from studies.shared.trained import Trainer, default_folder


def count(text: str) -> int:
    """The type of an option that is a whole number of 1 or more."""
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is not 1 or more")
    return number


def seed(text: str) -> int:
    """The type of an option that is a whole number of 0 or more."""
    number = int(text)
    if number < 0:
        raise argparse.ArgumentTypeError(f"{text} is not 0 or more")
    return number


def positive(text: str) -> float:
    """The type of an option that is a finite number above 0."""
    number = float(text)
    if not 0 < number < inf:
        raise argparse.ArgumentTypeError(f"{text} is not a finite number above 0")
    return number


READING = "mapping unit up floor"
OPTIONS = {
    "manifold": "model",
    "folders": "data",
    "material": f"data test unseen {READING}",
    "actions": f"data test actions minutes {READING}",
    "schedule": "epochs rate batch steps weight optimiser",
    "sizes": "hidden latent frames burn_in",
    "trainer": "cache quiet",
    "seed": "seed",
}
"""Parameter of `run` to its options."""
COUNT: dict[str, Any] = {"type": count, "metavar": "N"}
SETTINGS: dict[str, dict[str, Any]] = {
    "seed": {"type": seed, "default": 0, "help": "seed of all random numbers (default: 0)"},
    "quiet": {"action": "store_true", "help": "show no progress"},
    "cache": {
        "type": Path,
        "metavar": "FOLDER",
        "default": default_folder(),
        "help": f"folder that keeps trained networks (default: {default_folder()})",
    },
    "mapping": {
        "type": Path,
        "metavar": "JSON",
        "action": "append",
        "default": [],
        "help": "file with the names of our joints in an unknown rig (made by `numpy-cae rig`); of "
        "several --mapping options each motion uses the first that fits",
    },
    "unit": {
        "type": positive,
        "metavar": "METRES",
        "help": "length unit of the files in metres, such as 0.01 (default: guessed)",
    },
    "up": {
        "choices": ("x", "y", "z", "-x", "-y", "-z"),
        "help": "axis that points up; --up=-z for -z (default: guessed)",
    },
    "floor": {
        "type": float,
        "metavar": "METRES",
        "help": "height of the floor along the up axis (default: guessed)",
    },
    "model": {
        "type": Path,
        "metavar": "FILE",
        "help": "model file (default: the starter model)",
    },
    "data": {
        "type": Path,
        "metavar": "FOLDER",
        "nargs": "+",
        "default": [],
        "help": "folders of motion files",
    },
    "test": {
        "nargs": "+",
        "metavar": "PATTERN",
        "default": [],
        "help": "names of the test files, if the model records none",
    },
    "unseen": {"action": "store_true", "help": "the model has seen none of these files"},
    "actions": {
        "nargs": "+",
        "choices": ACTIONS,
        "default": ACTIONS,
        "metavar": "NAME",
        "help": f"actions to synthesise without --data, of {', '.join(ACTIONS)} (default: all)",
    },
    "minutes": {
        "type": positive,
        "default": 30.0,
        "metavar": "M",
        "help": "minutes of each synthetic action to train on, and to test on (default: 30)",
    },
    "weight": {
        "type": positive,
        "default": 1.0,
        "metavar": "λ",
        "help": "weight of the regulariser (default: 1)",
    },
    "optimiser": {
        "choices": ("adam", "sgd"),
        "default": "adam",
        "help": "Adam with one cycle, or SGD with momentum and a decaying rate (default: adam)",
    },
    "rate": {
        "type": positive,
        "metavar": "N",
        "help": "learning rate of the first epoch, or with Adam the peak",
    },
    "epochs": COUNT | {"help": "number of epochs"},
    "batch": COUNT | {"help": "number of clips in one step"},
    "steps": COUNT | {"help": "number of steps in an epoch"},
    "hidden": COUNT | {"help": f"number of hidden units of each GRU (default: {HIDDEN})"},
    "latent": COUNT | {"help": f"number of latent variables (default: {LATENT})"},
    "frames": COUNT | {"help": f"number of frames in a clip, at 25 a second (default: {CLIP})"},
    "burn_in": COUNT | {"help": "steps of the decoder before the first frame (default: 5)"},
}
"""Option to the arguments of `add_argument`."""
LISTED = 5
"""At most this many patterns of test takes are printed."""


def add_options(parser: argparse.ArgumentParser, runs: Iterable[Callable]) -> None:
    """Add the options of every parameter of the studies, each option once."""
    options: dict[str, dict[str, Any]] = {}
    for run in runs:
        for name, parameter in parameters(run).items():
            if name in OPTIONS:
                for option in OPTIONS[name].split():
                    options[option] = SETTINGS[option]
            else:
                options[name] = settings_of(parameter.default)
    for option, settings in options.items():
        flags = [f"--{option}"]
        if option == "model":
            flags.append("-m")
        parser.add_argument(*flags, **settings)


def parameters(run: Callable) -> dict[str, inspect.Parameter]:
    """The parameters of a study by name."""
    return dict(inspect.signature(run).parameters)


def settings_of(default: Any) -> dict[str, Any]:
    """The arguments of `add_argument` for a parameter with this default.

    The type is that of the default, or of its items if it is a tuple. A parameter whose default is
    None, or that has no default, is a path.
    """
    if default is False:
        return {"action": "store_true"}
    if default is None:
        return {"type": Path, "metavar": "PATH"}
    if default is inspect.Parameter.empty:
        return {"type": Path, "metavar": "PATH", "required": True}
    if isinstance(default, tuple):
        values = " ".join(map(str, default))
        item_type = type(default[0])
        return {"type": item_type, "nargs": "+", "default": default, "help": f"default: {values}"}
    return {"type": type(default), "default": default, "help": f"default: {default}"}


class Inputs:
    """The values of the parameters of `run`, each made once from the options."""

    def __init__(self, args: argparse.Namespace):
        self.args = args

    def of(self, run: Callable) -> dict[str, Any]:
        """The arguments of a study: properties of this class, and options as they are."""
        values = {}
        for name in parameters(run):
            source = self if hasattr(Inputs, name) else self.args
            values[name] = getattr(source, name)
        return values

    @cached_property
    def reading(self) -> dict[str, Any]:
        """How motion files are read, as arguments of `load_motion`."""
        args = self.args
        mappings = [read_mapping(path) for path in args.mapping]
        reading = {"unit": args.unit, "up": args.up, "floor": args.floor}
        if len(mappings) == 1:
            return reading | {"mapping": mappings[0]}  # a file that it does not fit is refused
        return reading | {"mapping": mappings or None}

    @cached_property
    def folders(self) -> list[Path]:
        """The folders of --data; ValueError if there is none."""
        if not self.args.data:
            raise ValueError("--data is missing: name folders of motion files")
        return self.args.data

    @cached_property
    def manifold(self) -> MotionManifold:
        """The convolutional model of --model, or the starter model."""
        path = self.args.model
        if path is None:
            return starter()
        if not path.exists():
            raise ValueError(f"{path}: no such file; leave -m out for the starter model")
        manifold = load_manifold(path)
        if not isinstance(manifold, MotionManifold):
            raise ValueError(f"{path}: not a convolutional, but a sequential manifold")
        return manifold

    @cached_property
    def material(self) -> Material | None:
        """The takes of --data, split by --test; None without --data."""
        if not self.args.data:
            return None
        material = read_material(self.args.data, self.patterns, **self.reading)
        if not (material.testing and material.training):
            purpose = "learn from" if material.testing else "test"
            patterns = " ".join(self.patterns[:LISTED])
            problem = f"--data holds no take to {purpose}: the test takes are {patterns}"
            if not self.args.unseen:
                problem += "; if the model has seen none of these files, add --unseen"
            raise ValueError(problem)
        note(material.counted())
        return material

    @cached_property
    def patterns(self) -> list[str]:
        """The patterns of the test files: those that the model records, else --test. Of files that
        the model (--unseen) or the starter model has not seen, every fifth is for testing."""
        args = self.args
        model = getattr(args, "model", None)
        recorded = []
        if "model" in args:
            recorded = list(self.manifold.settings.get("test") or [])
        if args.unseen or model is None:
            return self._patterns_of_unseen(recorded)
        if recorded and args.test and sorted(recorded) != sorted(args.test):
            raise ValueError(
                f"{model} was trained without {' '.join(recorded)}: other test takes, "
                f"{args.test}, may be ones that it has seen. Leave --test out"
            )
        if not (recorded or args.test):
            raise ValueError(f"{model} names no test takes: give --test, such as '*_005.bvh'")
        return recorded or args.test

    def _patterns_of_unseen(self, recorded: list[str]) -> list[str]:
        """Those of --test, else every fifth file. Without --unseen, those of which the starter
        model records that it has not learned from them come first."""
        args = self.args
        files = []
        for folder in args.data:
            files += find_motion_files(folder)
        if args.test:
            return args.test
        if not args.unseen and any(matches_any(path, recorded) for path in files):
            return recorded
        return [escape(path.name) for path in files[4::5] or files[:1]]

    @cached_property
    def actions(self) -> list[Action]:
        """The actions of jang2018, read or synthesised."""
        args = self.args
        if not args.data:
            return [
                synthetic_action(name, args.minutes, args.seed, args.quiet) for name in args.actions
            ]
        actions = [read_action(folder, args.test, **self.reading) for folder in args.data]
        for action in actions:
            if not (action.training and action.testing):
                purpose = "train" if action.testing else "test"
                raise ValueError(f"--test leaves nothing of {action.name} to {purpose}")
        return actions

    @cached_property
    def schedule(self) -> SequenceSchedule:
        """The schedule of the sequential network, changed as the options say."""
        recipe = "fast" if self.args.optimiser == "adam" else "paper"
        changes = self._options_that_are_set("epochs", "rate", "batch", "steps", "weight")
        return replace(SEQUENCE_RECIPES[recipe], **changes)

    @cached_property
    def sizes(self) -> dict[str, int]:
        """The sizes of the sequential network, as far as the options say."""
        sizes = self._options_that_are_set("hidden", "latent", "frames", "burn_in")
        if sizes.get("frames", 3) < 3:
            raise ValueError(f"--frames is {self.args.frames}, expected 3 or more")
        return sizes

    def _options_that_are_set(self, *names: str) -> dict[str, Any]:
        values = {name: getattr(self.args, name) for name in names}
        return {name: value for name, value in values.items() if value is not None}

    @cached_property
    def trainer(self) -> Trainer:
        """What trains networks, and keeps them in the folder of --cache."""
        return Trainer(self.args.cache, self.progress)

    @cached_property
    def progress(self) -> Callable | None:
        """What reports the progress of a training."""
        return None if self.args.quiet else ProgressPrinter()
