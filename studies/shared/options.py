"""The options of `python -m studies NAME`: each parameter of the study's `run` has its own.

`OPTIONS` has the parameters that many studies share; `Inputs` makes their values. Any other
parameter is an option of its name, with the type of its default.
"""

import argparse
import inspect
import platform
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from glob import escape
from pathlib import Path
from typing import Any

import numpy as np
import scipy

import numpy_cae
from numpy_cae.cli.shared import arguments, one_motion, train_options
from numpy_cae.cli.shared.output import note
from numpy_cae.manifold import MotionManifold, SequenceManifold
from numpy_cae.mocap import find_motion_files
from numpy_cae.mocap.load import is_test
from numpy_cae.training import ProgressPrinter, SequenceSchedule
from studies.jang2018.actions import ACTIONS, Action, read_action, synthetic_action
from studies.shared.material import Material, read_material

READING = {f"--{name}": arguments.SHARED[name] for name in ("mapping", "unit", "up", "floor")}
DATA = {"--data": arguments.FOLDERS | {"default": [], "help": "folders of motion files"}}
TEST = {
    "--test": arguments.PATTERNS
    | {"help": "names of the test files, where the model does not record them"}
}
OPTIONS: dict[str, dict[str, dict[str, Any]]] = {
    "manifold": {"--model": arguments.FILE | {"help": "model file (default: the starter model)"}},
    "folders": DATA,
    "material": DATA
    | TEST
    | {"--unseen": arguments.FLAG | {"help": "the model has seen none of these files"}}
    | READING,
    "actions": DATA
    | TEST
    | {
        "--actions": {"nargs": "+", "choices": ACTIONS, "default": ACTIONS, "metavar": "NAME"}
        | {"help": f"actions to synthesise without --data, of {', '.join(ACTIONS)}"},
        "--minutes": {"type": arguments.positive, "default": 30.0}
        | {"help": "minutes of each synthetic action to train on, and to test on (default: 30)"},
    }
    | READING,
    "schedule": {
        f"--{name}": {"type": arguments.rate if name == "rate" else arguments.positive_number}
        | {"metavar": "N", "help": text}
        for name, text in (
            *train_options.COMMON.items(),
            ("steps", train_options.SEQUENTIAL["steps"]),
        )
    },
    "network": {
        f"--{name}": arguments.COUNT | {"help": train_options.SEQUENTIAL[name]}
        for name in ("hidden", "latent", "frames")
    },
    "progress": {"--quiet": arguments.SHARED["quiet"]},
    "seed": {"--seed": arguments.SHARED["seed"]},
}
"""Parameter of `run` to its options, each with the arguments of `add_argument`."""
SHORT = {"--model": "-m"}


def parameters(run: Callable) -> Mapping[str, inspect.Parameter]:
    """The parameters of a study by name."""
    return inspect.signature(run).parameters


def add_options(parser: argparse.ArgumentParser, runs: Iterable[Callable]) -> None:
    """Add the options of every parameter of the studies, each option once."""
    options: dict[str, dict[str, Any]] = {}
    for name, parameter in ((n, p) for run in runs for n, p in parameters(run).items()):
        options |= OPTIONS.get(name) or {f"--{name}": _typed(parameter.default)}
    for flag, settings in options.items():
        flags = [SHORT[flag], flag] if flag in SHORT else [flag]
        parser.add_argument(*flags, **settings)


def _typed(default: Any) -> dict[str, Any]:
    """The arguments of `add_argument` for a parameter with this default."""
    if default is False:
        return dict(arguments.FLAG)
    if default is None or default is inspect.Parameter.empty:
        return {"type": Path, "required": default is not None, "metavar": "PATH"}
    several = isinstance(default, tuple)
    one = type(default[0] if several else default)
    shown = " ".join(map(str, default)) if several else default
    return {"type": one, "default": default, "help": f"default: {shown}"} | (
        {"nargs": "+"} if several else {}
    )


class Inputs:
    """The values of the parameters of `run`, each made once from the options."""

    def __init__(self, args: argparse.Namespace):
        self.args = args

    def of(self, run: Callable) -> dict[str, Any]:
        """The arguments of a study."""
        known = {name for name in OPTIONS if name != "seed"}
        return {n: getattr(self if n in known else self.args, n) for n in parameters(run)}

    @cached_property
    def folders(self) -> list[Path]:
        """The folders of --data; ValueError if none is given."""
        if not self.args.data:
            raise ValueError("--data is missing: name folders of motion files")
        return self.args.data

    @cached_property
    def manifold(self) -> MotionManifold:
        """The model of --model, or the starter model."""
        manifold = one_motion.load_model(self.args)
        assert not isinstance(manifold, SequenceManifold)
        return manifold

    @cached_property
    def material(self) -> Material | None:
        """The takes of --data, split by --test; None without --data."""
        if not self.args.data:
            return None
        patterns = self.patterns
        material = read_material(self.args.data, patterns, *arguments.reading(self.args))
        if not (material.testing and material.training):
            which = "learn from" if material.testing else "test"
            problem = f"--data holds no take to {which}: the test takes are {_listed(patterns)}"
            raise ValueError(f"{problem}; if the model has seen none of these files, add --unseen")
        note(_counted(material))
        return material

    @cached_property
    def patterns(self) -> list[str]:
        """The patterns of the test files: those that the model records, else --test. Of files that
        the model (--unseen) or the starter model has not seen, every fifth is for testing."""
        args = self.args
        model = getattr(args, "model", None)
        recorded = list(self.manifold.settings.get("test") or []) if hasattr(args, "model") else []
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
            quiet = getattr(args, "quiet", False)
            return [synthetic_action(n, args.minutes, args.seed, quiet) for n in args.actions]
        reading = arguments.reading(args)
        actions = [read_action(f.resolve().name, [f], args.test, *reading) for f in args.data]
        for action in actions:
            if not (action.training and action.testing):
                which = "train" if action.testing else "test"
                raise ValueError(f"--test leaves nothing of {action.name} to {which}")
        return actions

    @cached_property
    def schedule(self) -> SequenceSchedule:
        """The schedule of the sequential network."""
        return train_options.sequence_schedule_of(self.args, "fast")

    @cached_property
    def network(self) -> dict[str, int]:
        """The sizes of the sequential network that are given."""
        sizes = train_options.given(self.args, "hidden", "latent", "frames")
        if sizes.get("frames", 3) < 3:
            raise ValueError(f"--frames is {self.args.frames}, expected 3 or more")
        return sizes

    @cached_property
    def progress(self) -> Callable | None:
        """What reports the progress of a training, from the training's name."""
        return None if self.args.quiet else ProgressPrinter

    def provenance(self, run: Callable) -> dict[str, str]:
        """What must be known to repeat a study: data, model, options, versions."""
        made, names = vars(self), parameters(run)
        given = {n: str(getattr(self.args, n)) for n in names if n not in OPTIONS}
        if "data" in self.args and self.args.data:
            given["data"] = ", ".join(folder.name for folder in self.args.data)
        if "material" in names and made.get("material"):
            given["data"] += f": {_counted(self.material)}"
            given["test takes"] = f"{_listed(self.patterns)}, never trained on or fitted to"
        if "manifold" in names:
            given |= _of_model(self.manifold, self.args.model)
        for name in ("schedule", "network"):
            if name in names:
                given[name] = str(made[name])
        if "seed" in names:
            given["seed"] = str(self.args.seed)
        versions = f"numpy_cae {numpy_cae.__version__}, NumPy {np.__version__}"
        versions += f", SciPy {scipy.__version__}, Python {platform.python_version()}"
        return given | {"versions": versions}


def _counted(material: Material) -> str:
    return f"{len(material.training)} takes to fit baselines to, {len(material.testing)} to test"


def _listed(patterns: list[str]) -> str:
    more = f" and {len(patterns) - 5} more" if patterns[5:] else ""
    return " ".join(patterns[:5]) + more


def _of_model(manifold: MotionManifold, path: Path | None) -> dict[str, str]:
    """What a model records of its training."""
    settings = manifold.settings.get
    learned = f"learned from {settings('takes')} takes, {settings('windows')} windows of "
    learned += f"{settings('window')} frames, seed {settings('seed')}"
    stages = []
    for name, words in (("layer", "layer by layer"), ("fine_tuning", "all layers at once")):
        if (stage := settings("schedule", {}).get(name)) and stage["epochs"]:
            how = f"{stage['epochs']} epochs in batches of {stage['batch']}, by "
            stages.append(f"{words}: {how}{stage['optimiser']} with a rate of {stage['rate']:g}")
    given = {"model": f"{path.name if path else 'starter model'}, {learned}"}
    given["learned from"] = ", ".join(folder["name"] for folder in settings("folders") or ())
    given["training"] = "; ".join(stages)
    return {name: text for name, text in given.items() if text}
