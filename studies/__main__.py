"""Run studies and print their results: `python -m studies NAME ... [options]`."""

import argparse
import ast
import inspect
import json
import platform
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import import_module
from itertools import takewhile
from pathlib import Path
from types import ModuleType

import numpy as np
import scipy

import numpy_cae
from numpy_cae.cli.shared.output import note, visible_output, working
from numpy_cae.errors import NumpyCaeError
from numpy_cae.viz import save_viewer
from studies.shared.options import OPTIONS, Inputs, add_options, parameters
from studies.shared.result import Result, data, png, report, text

HERE = Path(__file__).parent
NAMES = sorted(path.stem for path in HERE.glob("[!_]*.py"))
"""The studies, which are the modules beside this one."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the studies that are named first, with the options that follow; without a name, list
    them. The exit status is 2 if none could be run."""
    words = sys.argv[1:] if argv is None else list(argv)
    names = list(takewhile(lambda word: not word.startswith("-"), words))
    with visible_output():
        try:
            return _run(names, words[len(names) :]) if names else _list()
        except (NumpyCaeError, ValueError, ArithmeticError, OSError) as error:
            print(f"python -m studies {' '.join(names)}: {error}", file=sys.stderr)
            return 2


def _list() -> int:
    print("python -m studies NAME ... [options], of these; --help lists the options of a study:\n")
    for name in NAMES:
        docstring = ast.get_docstring(ast.parse((HERE / f"{name}.py").read_text("utf-8"))) or ""
        print(f"{name:24}{' '.join(docstring.split()).split('. ')[0].rstrip('.')}.")
    return 0


def _run(names: list[str], words: list[str]) -> int:
    for name in (name for name in names if name not in NAMES):
        raise ValueError(f"no study {name}; `python -m studies` lists them")
    modules = {name: import_module(f"studies.{name}") for name in names}
    parser = argparse.ArgumentParser(
        prog=f"python -m studies {' '.join(names)}",
        description="\n\n".join(module.__doc__ or "" for module in modules.values()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_options(parser, (module.run for module in modules.values()))
    parser.add_argument("-o", "--output", type=Path, help="folder for a report, JSON and pictures")
    args = parser.parse_args(words)
    inputs = Inputs(args)
    results = {}
    for name, module in modules.items():
        result = results[name] = _measured(name, module, inputs, alone=len(names) == 1)
        print(text(result), end="\n\n", flush=True)
    if args.output:
        _write(results, args.output)
    return 0 if any(result.tables for result in results.values()) else 2


def _measured(name: str, module: ModuleType, inputs: Inputs, alone: bool) -> Result:
    """The result of a study with its provenance. Where a study among others cannot be run, its
    result has no tables and its note says why."""
    try:
        given = inputs.of(module.run)
        began = time.monotonic()
        processor = time.process_time()
        with working(name):
            result = module.run(**given)
    except (NumpyCaeError, ValueError, ArithmeticError) as error:
        if alone:
            raise
        note(f"{name} could not be run: {error}")
        return Result(name.replace("_", " "), [], note=f"Could not be run: {error}.")
    seconds = f"{time.monotonic() - began:.0f} s, {time.process_time() - processor:.0f} s of the "
    about = inspect.getdoc(module) or ""
    made = result.provenance | provenance(module.run, inputs) | {"time": f"{seconds}processor"}
    return replace(result, about=about, provenance=made)


def _write(results: dict[str, Result], folder: Path) -> None:
    """Write the results as Markdown and as JSON, and each figure as a file of its own."""
    folder.mkdir(parents=True, exist_ok=True)
    each = {name: data(result) for name, result in results.items()}
    numbers = json.dumps(each, indent=1, default=lambda value: value.item())
    (folder / "report.json").write_text(numbers, "utf-8")
    (folder / "report.md").write_text(report(results), "utf-8", errors="backslashreplace")
    for result in results.values():
        for name, picture in result.figures.items():
            (folder / f"{name}.png").write_bytes(png(picture))
            if picture.actors:
                save_viewer(picture.actors, folder / f"{name}.html", picture.rate)
    claims = [claim for result in results.values() for claim in result.claims]
    confirmed = sum(bool(claim.confirmed) for claim in claims)
    print(f"{folder / 'report.md'}: {confirmed} of {len(claims)} claims confirmed")


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


if __name__ == "__main__":
    sys.exit(main())
