"""What must be known to repeat the measurements of a study."""

import platform
from collections.abc import Callable

import numpy as np
import scipy

import numpy_cae
from studies.shared.options import OPTIONS, Inputs, parameters


def provenance(run: Callable, inputs: Inputs) -> dict[str, str]:
    """Data, test takes, model, the options of the study's own, seed, versions."""
    made = vars(inputs)
    args = inputs.args
    given: dict[str, object] = {}
    if getattr(args, "data", None):
        given["data"] = ", ".join(folder.name for folder in args.data)
    if made.get("material"):
        given["data"] = f"{given['data']}: {inputs.material.counted()}"
        more = len(inputs.patterns) - 5
        listed = " ".join(inputs.patterns[:5]) + (f" and {more} more" if more > 0 else "")
        given["test takes"] = f"{listed}, never trained on or fitted to"
    for name in parameters(run):
        if name == "manifold":
            given |= _of_model(inputs.manifold.settings, args.model.name if args.model else "")
        elif name not in OPTIONS:
            given[name] = made.get(name, getattr(args, name, None))
    if "seed" in parameters(run):
        given["seed"] = args.seed
    given["versions"] = (
        f"numpy_cae {numpy_cae.__version__}, NumPy {np.__version__}, SciPy {scipy.__version__}, "
        f"Python {platform.python_version()}"
    )
    return {name: str(value) for name, value in given.items() if value not in ("", None)}


def _of_model(settings: dict, name: str) -> dict[str, str]:
    """What a model records of its training."""
    takes, windows, length, seed = map(settings.get, ("takes", "windows", "window", "seed"))
    learned = f"learned from {takes} takes, {windows} windows of {length} frames, seed {seed}"
    return {
        "model": f"{name or 'starter model'}, {learned}",
        "learned from": ", ".join(folder["name"] for folder in settings.get("folders") or ()),
        "training": str(settings.get("schedule", "")),
    }
