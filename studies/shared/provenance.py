"""What must be known to repeat the measurements of a study."""

import platform
from collections.abc import Callable

import numpy as np
import scipy

import numpy_cae
from studies.shared.options import OPTIONS, Inputs, parameters

LISTED = 5
"""LISTED: at most so many patterns of test takes are written."""


def provenance(run: Callable, inputs: Inputs) -> dict[str, str]:
    """Data, test takes, model, the options of the study's own, seed, versions."""
    made = vars(inputs)
    args = vars(inputs.args)
    given = {"data": ", ".join(folder.name for folder in args.get("data", []))}
    if made.get("material"):
        given["data"] += f": {inputs.material.counted()}"
        listed = " ".join(inputs.patterns[:LISTED]) + " …" * (len(inputs.patterns) > LISTED)
        given["test takes"] = f"{listed}, never trained on or fitted to"
    if "manifold" in made:
        settings = inputs.manifold.settings
        given["model"] = args["model"].name if args["model"] else "starter model"
        given["training"] = f"{settings.get('takes')} takes, {settings.get('windows')} windows, "
        given["training"] += f"seed {settings.get('seed')}, {settings.get('schedule')}"
    own = [name for name in parameters(run) if name == "seed" or name not in OPTIONS]
    given |= {name: str(args[name]) for name in own if args.get(name) is not None}
    given["versions"] = (
        f"numpy_cae {numpy_cae.__version__}, NumPy {np.__version__}, SciPy {scipy.__version__}, "
        f"Python {platform.python_version()}"
    )
    return {name: value for name, value in given.items() if value}
