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

PUBLISHED = {"sources": "sources"}
"""Experiments that train their own networks: `run(folders, seed) -> Result`. They are run only if
they are named."""


def run_experiment(name: str, *given: object, seed: int = 0) -> Result:
    """Run one of `EXPERIMENTS` (`given` a manifold and material) or of `PUBLISHED` (given folders);
    where it cannot be run, the result has no tables and its note says why."""
    run = import_module(f"numpy_cae.experiments.{(EXPERIMENTS | PUBLISHED)[name]}").run
    try:
        return run(*given, seed)
    except (ValueError, ArithmeticError) as error:
        return Result(name.replace("_", " "), [], note=f"Could not be run: {error}.")
