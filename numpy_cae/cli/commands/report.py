"""Run every experiment of holden2015, section 7, on the takes that the model was not trained on.
Write report.html (one self-contained page: each claim and whether it is confirmed, tables and
pictures), and the same as report.json. `--only real` measures repair on files of any kind, without
a truth. The exit status is 2 if no experiment could be run.

examples:
  numpy-cae report --data motions/ -m model.npz -o report
  numpy-cae report --only real --data takes_from_video/ -o report
"""

import argparse
import json
import time
from glob import escape
from pathlib import Path

import numpy as np

from numpy_cae.cli.shared import arguments, one_motion
from numpy_cae.cli.shared.output import note, working, write_texts
from numpy_cae.experiments.material import Material, read_material
from numpy_cae.experiments.page import page
from numpy_cae.experiments.registry import EXPERIMENTS, FILES, MODULES, run_experiment
from numpy_cae.experiments.result import Result
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap import find_motion_files
from numpy_cae.mocap.load import is_test


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The motions, the model, the folder and the experiments."""
    add, names = parser.add_argument, tuple(EXPERIMENTS)
    add("--data", **arguments.FOLDERS, required=True, help="folders of motion files")
    model = "model file from `numpy-cae train --test PATTERN` (default: the starter model)"
    add("-m", "--model", type=Path, help=model)
    output = "folder to write, created if it does not exist (default: report)"
    add("-o", "--output", **arguments.FOLDER, default=Path("report"), help=output)
    test = "names of the test files, where the model does not record them (default for the "
    test += "starter model, for data that it has not seen: every fifth file)"
    add("--test", **arguments.PATTERNS, help=test)
    unseen = "the model has seen none of these files: test on --test or on every fifth file"
    add("--unseen", **arguments.FLAG, help=unseen)
    others = ", ".join(name for name in MODULES if name not in names)
    only = f"run only these, of {', '.join(names)} (the default) and {others}"
    add("--only", nargs="+", choices=MODULES, default=names, metavar="NAME", help=only)
    arguments.add_shared(parser, "seed mapping unit up floor")


def run(args: argparse.Namespace) -> int:
    """Read, measure, write."""
    started = time.monotonic()
    given: dict[str, tuple] = {}
    provenance = {"data": ", ".join(folder.name for folder in args.data)}
    if of_files := set(args.only) & set(FILES):
        given |= dict.fromkeys(of_files, (one_motion.load_model(args), args.data))
    if of_takes := set(args.only) & set(EXPERIMENTS):
        *both, provenance = _read(args, provenance["data"])
        given |= dict.fromkeys(of_takes, tuple(both))
    args.output.mkdir(parents=True, exist_ok=True)
    results: dict[str, Result] = {}
    for number, name in enumerate(given, start=1):
        note(f"[{number}/{len(given)}] {name} …")
        with working(name):
            result = results[name] = run_experiment(name, *given[name], seed=args.seed)
        counted = f"{result.confirmed} of {len(result.claims)} claims confirmed"
        note(f"{name}: {counted if result.claims else result.note}")
    seconds = time.monotonic() - started
    provenance["made by"] = f"NumPy {np.__version__}, seed {args.seed}, {seconds:.0f} s"
    _write(results, provenance, args.output)
    return 0 if any(result.tables for result in results.values()) else 2


def _write(results: dict[str, Result], provenance: dict[str, str], folder: Path) -> None:
    """Write the report as a page and as JSON, and print how many claims are confirmed."""
    data = {"provenance": provenance, "results": {n: r.data() for n, r in results.items()}}
    texts = {
        "report.html": page(results, provenance),
        "report.json": json.dumps(data, indent=1, default=lambda value: value.item()),
    }
    write_texts(folder, texts)
    confirmed = sum(result.confirmed for result in results.values())
    claims = sum(len(result.claims) for result in results.values())
    print(f"{folder / 'report.html'}: {confirmed} of {claims} claims confirmed")


def _read(args: argparse.Namespace, data: str) -> tuple[MotionManifold, Material, dict[str, str]]:
    """The model, the takes, and what a reader of the report must know of both."""
    manifold = one_motion.load_model(args)
    patterns = _test_patterns(manifold, args)
    listed = " ".join(patterns[:5]) + (f" and {len(patterns) - 5} more" if patterns[5:] else "")
    material = read_material(args.data, patterns, *arguments.reading(args))
    if not (material.testing and material.training):
        which = "learn from" if material.testing else "test"
        advice = "if the model has seen none of these files, add --unseen"
        problem = f"--data holds no take to {which}: the test takes are {listed}"
        raise ValueError(f"{problem}; {advice}")
    counts = f"{len(material.training)} takes to fit baselines to, {len(material.testing)} to test"
    note(counts)
    settings = manifold.settings.get
    folders = [folder["name"] for folder in settings("folders") or ()]
    provenance = {
        "model": f"{args.model.name if args.model else 'starter model'}, learned from "
        f"{settings('takes')} takes, {settings('windows')} windows of {settings('window')} frames, "
        f"seed {settings('seed')}",
        "learned from": ", ".join(folders),
        "data": f"{data}: {counts}",
        "test takes": f"{listed}, by take, never trained on or fitted to",
        "training": _in_words(settings("schedule", {})),
    }
    return manifold, material, {name: text for name, text in provenance.items() if text}


def _in_words(schedule: dict) -> str:
    """The schedule that a model records, in words."""
    stages = []
    for name, words in (("layer", "layer by layer"), ("fine_tuning", "all layers at once")):
        if stage := schedule.get(name):
            how = f"{stage['epochs']} epochs in batches of {stage['batch']}, by "
            how += f"{stage['optimiser']} with a rate of {stage['rate']:g}"
            stages.append(f"{words}: {how if stage['epochs'] else 'left out'}")
    return "; ".join(stages)


def _test_patterns(manifold: MotionManifold, args: argparse.Namespace) -> list[str]:
    """The patterns of the test files: those that the model records, else --test. Of files that the
    model (--unseen) or the starter model has not seen, every fifth is for testing."""
    recorded = list(manifold.settings.get("test") or [])
    if args.unseen or args.model is None:
        files = [path for folder in args.data for path in find_motion_files(folder)]
        if not args.unseen and not args.test and any(is_test(path, recorded) for path in files):
            return recorded
        return args.test or [escape(path.name) for path in files[4::5] or files[:1]]
    if recorded and args.test and sorted(recorded) != sorted(args.test):
        raise ValueError(
            f"{args.model} was trained without {' '.join(recorded)}: other test takes, "
            f"{args.test}, may be ones that it has seen. Leave --test out"
        )
    if not (recorded or args.test):
        raise ValueError(f"{args.model} names no test takes: give --test, such as '*_005.bvh'")
    return recorded or args.test
