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
from pathlib import Path
from typing import Any

from numpy_cae.cli.commands import train
from numpy_cae.cli.shared import arguments, files
from numpy_cae.cli.shared.output import note
from numpy_cae.manifold.model_file import Manifold
from numpy_cae.mocap import find_motion_files
from numpy_cae.mocap.load import is_test
from numpy_cae.training import ProgressPrinter, SequenceSchedule
from studies.jang2018.actions import ACTIONS, Action, read_action, synthetic_action
from studies.shared.material import Material, read_material

READING = "mapping unit up floor"
OPTIONS = {
    "manifold": "model",
    "folders": "data",
    "material": f"data test unseen {READING}",
    "actions": f"data test actions minutes {READING}",
    "schedule": "epochs rate batch steps weight optimiser",
    "network": "hidden latent frames burn_in",
    "progress": "quiet",
    "seed": "seed",
}
"""Parameter of `run` to its options."""
FLAG = {
    **arguments.SHARED,
    "model": arguments.FILE | {"help": "model file (default: the starter model)"},
    "data": arguments.FOLDERS | {"default": [], "help": "folders of motion files"},
    "test": arguments.PATTERNS | {"help": "names of the test files, if the model records none"},
    "unseen": arguments.FLAG | {"help": "the model has seen none of these files"},
    "actions": {"nargs": "+", "choices": ACTIONS, "default": ACTIONS, "metavar": "NAME"}
    | {"help": f"actions to synthesise without --data, of {', '.join(ACTIONS)} (default: all)"},
    "minutes": {"type": arguments.positive, "default": 30.0, "metavar": "M"}
    | {"help": "minutes of each synthetic action to train on, and to test on (default: 30)"},
    "weight": {"type": arguments.positive, "default": 1.0, "metavar": "λ"}
    | {"help": "weight of the regulariser (default: 1)"},
    "optimiser": {"choices": ("adam", "sgd"), "default": "adam"}
    | {"help": "Adam with one cycle, or SGD with momentum and a decaying rate (default: adam)"},
    "burn_in": {"type": arguments.positive_number, "metavar": "N"}
    | {"help": "steps of the decoder before the first frame (default: 5)"},
    **{
        name: {"type": arguments.positive_number, "metavar": "N", "help": text}
        for name, text in (train.COMMON | train.SEQUENTIAL).items()
    },
}
"""Option to the arguments of `add_argument`."""
FLAG["rate"]["type"] = arguments.rate


def add_options(parser: argparse.ArgumentParser, runs: Iterable[Callable]) -> None:
    """Add the options of every parameter of the studies, each option once."""
    options: dict[str, dict[str, Any]] = {}
    for name, parameter in (pair for run in runs for pair in parameters(run).items()):
        if name in OPTIONS:
            options |= {flag: FLAG[flag] for flag in OPTIONS[name].split()}
        else:
            options[name] = _typed(parameter.default)
    for flag, settings in options.items():
        parser.add_argument(*["-m"] * (flag == "model"), f"--{flag}", **settings)


def parameters(run: Callable) -> dict[str, inspect.Parameter]:
    """The parameters of a study by name."""
    return dict(inspect.signature(run).parameters)


def _typed(default: Any) -> dict[str, Any]:
    """The arguments of `add_argument` for a parameter with this default: None or no default is that
    of a path."""
    if default is False:
        return dict(arguments.FLAG)
    if default in (None, inspect.Parameter.empty):
        return {"type": Path, "required": default is not None, "metavar": "PATH"}
    values = default if isinstance(default, tuple) else (default,)
    settings = {"type": type(values[0]), "default": default, "help": f"default: {values}"}
    return settings | ({"nargs": "+"} if values is default else {})


class Inputs:
    """The values of the parameters of `run`, each made once from the options."""

    def __init__(self, args: argparse.Namespace):
        self.args = args

    def of(self, run: Callable) -> dict[str, Any]:
        """The arguments of a study."""
        return {
            name: getattr(self if hasattr(Inputs, name) else self.args, name)
            for name in parameters(run)
        }

    @cached_property
    def folders(self) -> list[Path]:
        """The folders of --data; ValueError if none is given."""
        if not self.args.data:
            raise ValueError("--data is missing: name folders of motion files")
        return self.args.data

    @cached_property
    def manifold(self) -> Manifold:
        """The model of --model, or the starter model."""
        return files.load_model(self.args)

    @cached_property
    def material(self) -> Material | None:
        """The takes of --data, split by --test; None without --data."""
        if not self.args.data:
            return None
        material = read_material(self.args.data, self.patterns, **arguments.reading(self.args))
        if not (material.testing and material.training):
            which = "learn from" if material.testing else "test"
            tested = " ".join(self.patterns[:5])
            problem = f"--data holds no take to {which}: the test takes are {tested}"
            raise ValueError(f"{problem}; if the model has seen none of these files, add --unseen")
        note(material.counted())
        return material

    @cached_property
    def patterns(self) -> list[str]:
        """The patterns of the test files: those that the model records, else --test. Of files that
        the model (--unseen) or the starter model has not seen, every fifth is for testing."""
        args = self.args
        model = getattr(args, "model", None)
        recorded = list(self.manifold.settings.get("test") or []) if "model" in args else []
        if args.unseen or model is None:
            files = [path for folder in args.data for path in find_motion_files(folder)]
            if not args.unseen and not args.test and any(is_test(p, recorded) for p in files):
                return recorded
            return args.test or [escape(path.name) for path in files[4::5] or files[:1]]
        if recorded and args.test and sorted(recorded) != sorted(args.test):
            raise ValueError(
                f"{model} was trained without {' '.join(recorded)}: other test takes, "
                f"{args.test}, may be ones that it has seen. Leave --test out"
            )
        if not (recorded or args.test):
            raise ValueError(f"{model} names no test takes: give --test, such as '*_005.bvh'")
        return recorded or args.test

    @cached_property
    def actions(self) -> list[Action]:
        """The actions of jang2018, read or synthesised."""
        args = self.args
        if not args.data:
            return [synthetic_action(n, args.minutes, args.seed, args.quiet) for n in args.actions]
        reading = arguments.reading(args)
        actions = [read_action(folder, args.test, **reading) for folder in args.data]
        for action in actions:
            if not (action.training and action.testing):
                which = "train" if action.testing else "test"
                raise ValueError(f"--test leaves nothing of {action.name} to {which}")
        return actions

    @cached_property
    def schedule(self) -> SequenceSchedule:
        """The schedule of the sequential network."""
        name = "fast" if self.args.optimiser == "adam" else "paper"
        schedule = train.sequence_schedule_of(self.args, name)
        return replace(schedule, weight=self.args.weight)

    @cached_property
    def network(self) -> dict[str, int]:
        """The sizes of the sequential network that are given."""
        sizes = train.given(self.args, "hidden", "latent", "frames", "burn_in")
        if sizes.get("frames", 3) < 3:
            raise ValueError(f"--frames is {self.args.frames}, expected 3 or more")
        return sizes

    @cached_property
    def progress(self) -> Callable | None:
        """What reports the progress of a training."""
        return None if self.args.quiet else ProgressPrinter()
