"""Run studies and print their results: `python -m studies NAME ... [options]`."""

import argparse
import ast
import inspect
import io
import json
import platform
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from importlib import import_module
from itertools import takewhile
from pathlib import Path
from types import ModuleType

import numpy as np
import scipy

import numpy_cae
from numpy_cae.atomic_write import atomic_write, make_folder, replacing, require_free
from numpy_cae.errors import NumpyCaeError
from numpy_cae.fast.thread_team import one_blas_thread
from studies.shared.messages import note
from studies.shared.options import LISTED, OPTIONS, Inputs, add_options, parameters
from studies.shared.result import CONFIRMED, Result, data, png, report, text, write_moving

HERE = Path(__file__).parent
NAMES = sorted(path.stem for path in HERE.glob("[!_]*.py"))
"""The studies, which are the modules beside this one."""
TIMED = "studies.speed"
"""The study that chooses the threads of BLAS by itself; all others use one."""
Errors = (NumpyCaeError, ValueError, ArithmeticError, OSError)
"""What a study raises where it cannot be run with these options or files."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the studies that are named first, with the options that follow; without a name, list
    them. The exit status is 2 if none could be run."""
    words = sys.argv[1:] if argv is None else list(argv)
    names = list(takewhile(lambda word: not word.startswith("-"), words))
    options = words[len(names) :]
    escape_unprintable(sys.stdout)
    escape_unprintable(sys.stderr)
    try:
        if names:
            return run_studies(names, options)
        list_studies()
        return 0
    except Errors as error:
        print(f"python -m studies {' '.join(names)}: {error}", file=sys.stderr)
        return 2


def escape_unprintable(stream: object) -> None:
    """Print characters that the encoding of a terminal or a file lacks, such as λ, as escapes."""
    if isinstance(stream, io.TextIOWrapper):
        stream.reconfigure(errors="backslashreplace")


def list_studies() -> None:
    """Print the name of each study and the first sentence of its docstring."""
    print("python -m studies NAME ... [options], of these; --help lists the options of a study:\n")
    for name in NAMES:
        module = ast.parse((HERE / f"{name}.py").read_text("utf-8"))
        words = (ast.get_docstring(module) or "").split()
        sentence = " ".join(words).split(". ")[0].rstrip(".")
        print(f"{name:24}{sentence}.")


def run_studies(names: list[str], options: list[str]) -> int:
    """Run the studies with these options, print their results and write them to --output."""
    for name in names:
        if name not in NAMES:
            raise ValueError(f"no study {name}; `python -m studies` lists them")
    modules = {name: import_module(f"studies.{name}") for name in names}
    args = parse(modules, options)
    inputs = Inputs(args)
    is_again = args.output is not None and has_report(args.output)
    results = {}
    for name, module in modules.items():
        if len(names) == 1:
            result = measure(module, inputs)
        else:
            result = measure_if_possible(name, module, inputs)
        results[name] = result
        print(text(result), end="\n\n", flush=True)
    if args.output:
        with replacing(is_again):
            write(results, args.output)
    return 0 if any(result.tables for result in results.values()) else 2


def parse(modules: dict[str, ModuleType], options: list[str]) -> argparse.Namespace:
    """The values of the options of these studies."""
    parser = argparse.ArgumentParser(
        prog=f"python -m studies {' '.join(modules)}",
        description="\n\n".join(module.__doc__ or "" for module in modules.values()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_options(parser, [module.run for module in modules.values()])
    parser.add_argument("-o", "--output", type=Path, help="folder for a report, JSON and pictures")
    return parser.parse_args(options)


def measure(module: ModuleType, inputs: Inputs) -> Result:
    """The result of a study, with its description and its provenance."""
    arguments = inputs.of(module.run)
    start = time.monotonic()
    processor_start = time.process_time()
    # A second thread of BLAS waits actively after each small product.
    with nullcontext() if module.__name__ == TIMED else one_blas_thread():
        result = module.run(**arguments)
    seconds = time.monotonic() - start
    processor_seconds = time.process_time() - processor_start
    measured = {"time": f"{seconds:.0f} s, {processor_seconds:.0f} s of the processor"}
    return replace(
        result,
        about=inspect.getdoc(module) or "",
        provenance=result.provenance | provenance(module.run, inputs) | measured,
    )


def measure_if_possible(name: str, module: ModuleType, inputs: Inputs) -> Result:
    """The result of a study; where it cannot be run, one without tables that says why."""
    note(f"{name} is measured")
    try:
        return measure(module, inputs)
    except (NumpyCaeError, ValueError, ArithmeticError) as error:
        note(f"{name} could not be run: {error}")
        return Result(name.replace("_", " "), [], note=f"Could not be run: {error}.")


def has_report(folder: Path) -> bool:
    """Whether a folder has an earlier report, whose files are replaced; FileError if it is a file
    or has other files of these names."""
    if folder.exists():
        make_folder(folder)  # raises FileError for a file
        if is_report(folder / "report.json"):
            return True
        with replacing(False):
            for name in ("report.json", "report.md"):
                require_free(folder / name)
    return False


def is_report(path: Path) -> bool:
    """Whether a file is the JSON of a report."""
    if not path.is_file():
        return False
    try:
        contents = json.loads(path.read_bytes())
    except (ValueError, RecursionError):
        return False
    if not contents or not isinstance(contents, dict):
        return False
    return all(isinstance(result, dict) and "provenance" in result for result in contents.values())


def write(results: dict[str, Result], folder: Path) -> None:
    """Write the results as Markdown and as JSON, and each figure as a file of its own."""
    make_folder(folder)
    contents = {name: data(result) for name, result in results.items()}
    numbers = json.dumps(contents, indent=1, default=lambda value: value.item())
    write_file(folder / "report.json", numbers.encode())
    write_file(folder / "report.md", report(results).encode(errors="backslashreplace"))
    claims = []
    for result in results.values():
        claims += result.claims
        for name, picture in result.figures.items():
            write_file(folder / f"{name}.png", png(picture))
            write_moving(picture, folder / f"{name}.html")
    confirmed = sum(claim.verdict == CONFIRMED for claim in claims)
    print(f"{folder / 'report.md'}: {confirmed} of {len(claims)} claims confirmed")


def write_file(path: Path, content: bytes) -> None:
    """Write a file completely or not at all."""
    with atomic_write(path) as temporary:
        temporary.write_bytes(content)


def provenance(run: Callable, inputs: Inputs) -> dict[str, str]:
    """Data, test takes, model, the study's own options, seed, versions; as far as it has them."""
    made_inputs = vars(inputs)
    options = vars(inputs.args)
    origin = {"data": ", ".join(folder.name for folder in options.get("data", []))}
    if made_inputs.get("material"):
        origin["data"] += f": {inputs.material.counted()}"
        patterns = " ".join(inputs.patterns[:LISTED])
        if len(inputs.patterns) > LISTED:
            patterns += " …"
        origin["test takes"] = f"{patterns}, never trained on or fitted to"
    if "manifold" in made_inputs:
        settings = inputs.manifold.settings
        origin["model"] = options["model"].name if options["model"] else "starter model"
        origin["training"] = (
            f"{settings.get('takes')} takes, {settings.get('windows')} windows, "
            f"seed {settings.get('seed')}, {settings.get('schedule')}"
        )
    for name in parameters(run):
        is_of_this_study = name == "seed" or name not in OPTIONS
        if is_of_this_study and options.get(name) is not None:
            origin[name] = str(options[name])
    origin["versions"] = (
        f"numpy_cae {numpy_cae.__version__}, NumPy {np.__version__}, SciPy {scipy.__version__}, "
        f"Python {platform.python_version()}"
    )
    return {name: value for name, value in origin.items() if value}


if __name__ == "__main__":
    sys.exit(main())
