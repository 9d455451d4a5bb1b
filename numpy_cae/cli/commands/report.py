"""Run every experiment of holden2015, section 7, on the takes that the model was not trained on.
Write report.html (one self-contained page: each claim and whether it is confirmed, tables and
pictures) and report.txt. `--only cmu35` needs no model: it trains on CMU subject 35 and compares
with published figures (get the files by `numpy-cae download cmu --subjects 35`). With --ablation,
measure what each choice of the paper contributes instead.

examples:
  numpy-cae report --data motions/ -m model.npz -o report
  numpy-cae report --only cmu35 --data cmu35/ -o report
  numpy-cae report --data motions/ --only damage -o report
  numpy-cae report --ablation
"""

import argparse
import time
from collections.abc import Sequence
from glob import escape
from pathlib import Path

import numpy as np

from numpy_cae.cli.shared import ablation, arguments, one_motion
from numpy_cae.cli.shared.output import note, print_json, working, write_texts
from numpy_cae.experiments.material import Material, is_test, read_material
from numpy_cae.experiments.page import page, plain_text
from numpy_cae.experiments.registry import EXPERIMENTS, PUBLISHED, run_experiment
from numpy_cae.experiments.result import Result
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import find_motion_files


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The motions, the model, the folder and the experiments."""
    add, names = parser.add_argument, tuple(EXPERIMENTS)
    add("--data", **arguments.FOLDERS, help="folders of motion files")
    model = "model file from `numpy-cae train --test PATTERN` (default: the starter model)"
    add("-m", "--model", type=Path, help=model)
    output = "folder to write, created if it does not exist"
    add("-o", "--output", **arguments.FOLDER, help=output)
    test = "names of the test files, where the model does not record them (default for the "
    test += "starter model, for data that it has not seen: every fifth file)"
    add("--test", **arguments.PATTERNS, help=test)
    unseen = "the model has seen none of these files: test on --test or on every fifth file"
    add("--unseen", **arguments.FLAG, help=unseen)
    only, choices = f"run only these, of {', '.join(names)} (the default)", (*names, *PUBLISHED)
    only += f" and {', '.join(PUBLISHED)}"
    add("--only", nargs="+", choices=choices, default=names, metavar="NAME", help=only)
    arguments.add_shared(parser, "seed json mapping unit up floor")
    ablation.add_arguments(parser)


def run(args: argparse.Namespace) -> int:
    """Read, measure, write."""
    if args.ablation:
        return ablation.run(args)
    own = [name for name in EXPERIMENTS if name in args.only]
    missing = [name for name in ("data", "output") if getattr(args, name) is None]
    if missing:
        needed = " and ".join(f"--{name}" for name in missing)
        raise ValueError(f"give {needed} (only --ablation does without)")
    started = time.monotonic()
    data = ", ".join(folder.name for folder in args.data)
    given: dict[str, tuple] = {name: (args.data,) for name in PUBLISHED if name in args.only}
    how = {"data": data}
    if own:
        manifold, material, how = _read(args, data)
        given = {name: (manifold, material) for name in own} | given
    args.output.mkdir(parents=True, exist_ok=True)
    results: dict[str, Result] = {}
    for name, inputs in given.items():
        with working(name):
            result = results[name] = run_experiment(name, *inputs, seed=args.seed)
        counted = f"{result.confirmed} of {len(result.claims)} claims confirmed"
        note(f"[{len(results)}/{len(given)}] {name}: {counted if result.claims else result.note}")
    seconds = time.monotonic() - started
    how |= {"made by": f"NumPy {np.__version__}, seed {args.seed}, {seconds:.0f} s"}
    html, text = page(results, how), plain_text(results.values(), how)
    write_texts(args.output, {"report.html": html, "report.txt": text})
    counts = {
        "confirmed": sum(result.confirmed for result in results.values()),
        "claims": sum(len(result.claims) for result in results.values()),
    }
    if args.json:
        experiments = [{"name": name} | result.data() for name, result in results.items()]
        print_json(counts | {"how": how, "experiments": experiments})
    else:
        counted = f"{counts['confirmed']} of {counts['claims']} claims confirmed"
        print(f"{args.output / 'report.html'}: {counted}")
    return 0


def _read(args: argparse.Namespace, data: str) -> tuple[MotionManifold, Material, dict[str, str]]:
    """The model, the takes, and what a reader of the report must know of both."""
    manifold = one_motion.load_model(args)
    patterns = _test_patterns(manifold, args)
    with working(f"reading {data}"):
        material = read_material(args.data, patterns, *arguments.reading(args))
    if not (material.testing and material.training):
        which = "learn from" if material.testing else "test"
        advice = "if the model has seen none of these files, add --unseen"
        found = f"--data holds no take to {which}: the test takes are {_listed(patterns)}"
        raise ValueError(f"{found}; {advice}")
    counts = f"{len(material.training)} takes to fit baselines to, {len(material.testing)} to test"
    note(counts)
    how = _provenance(args.model.name if args.model else "starter model", manifold) | {
        "data": f"{data}: {counts}",
        "test takes": f"{_listed(patterns)}, by take, never trained on or fitted to",
    }
    return manifold, material, how


def _test_patterns(manifold: MotionManifold, args: argparse.Namespace) -> list[str]:
    """The patterns of the test files: those that the model records, else --test; of files that the
    model (--unseen) or the starter model has not seen every fifth one."""
    own = list(manifold.settings.get("test") or [])
    if args.unseen or args.model is None:
        files = [path for folder in args.data for path in find_motion_files(folder)]
        if not args.unseen and not args.test and any(is_test(path, own) for path in files):
            return own
        return args.test or [escape(path.name) for path in files[4::5] or files[:1]]
    if own and args.test and sorted(own) != sorted(args.test):
        raise ValueError(
            f"{args.model} was trained without {' '.join(own)}: other test takes, {args.test}, "
            "may be ones that it has seen. Leave --test out"
        )
    if not (own or args.test):
        raise ValueError(f"{args.model} names no test takes: give --test, such as '*_005.bvh'")
    return own or args.test


def _listed(patterns: Sequence[str]) -> str:
    more = f" and {len(patterns) - 5} more" if len(patterns) > 5 else ""
    return " ".join(patterns[:5]) + more


def _provenance(name: str, manifold: MotionManifold) -> dict[str, str]:
    """What must be known of the model to judge the figures or to reproduce them."""
    of, layers = manifold.settings.get, manifold.network.layers
    schedule = of("schedule", {"layer": {}, "fine_tuning": {}})
    how = {
        "model": f"{name}, learned from {of('takes')} takes, {of('windows')} windows of "
        f"{of('window')} frames, seed {of('seed')}"
    }
    if of("folders"):
        how["learned from"] = ", ".join(
            f"{folder['name']} ({folder['files']} files, {folder['test']} of them kept for testing)"
            for folder in of("folders")
        )
    filters = [layer.b.size for layer in layers]
    return how | ablation.describe(filters, len(layers[0].w), **schedule)
