"""The experiments of `numpy-cae report`, by name."""

from importlib import import_module

from numpy_cae.experiments.result import Result

EXPERIMENTS = {
    "repair_sweep": "repair.repair_sweep",
    "filling_in": "repair.filling_in",
    "interpolation": "interpolation",
    "comparison": "comparison",
}
"""Name of each experiment to its module here, in the order of the report. A module has a function
`run(manifold, material, seed) -> Result`, which raises ValueError where the material lacks what the
experiment needs."""

FILES = {"real": "repair.real"}
"""Experiments on files of which the model has seen none: `run(manifold, folders, seed) -> Result`.
They are run only if they are named."""

MODULES = EXPERIMENTS | FILES


def run_experiment(name: str, *given: object, seed: int = 0) -> Result:
    """Run an experiment: those of `EXPERIMENTS` are `given` a manifold and material, `FILES` a
    manifold and folders. Where it cannot be run, the result has no tables and its note says why."""
    run = import_module(f"numpy_cae.experiments.{MODULES[name]}").run
    try:
        return run(*given, seed)
    except (ValueError, ArithmeticError) as error:
        return Result(name.replace("_", " "), [], note=f"Could not be run: {error}.")
