"""Run every experiment of holden2015, section 7, on the takes that the model was not trained on.
Write report.html (one self-contained page: each claim and whether it is confirmed, tables and
pictures), and the same as report.txt and report.json. `--only cmu35` needs no model: it trains on
CMU subject 35 and compares with published figures (get the files by `numpy-cae download cmu
--subjects 35`). With --ablation, measure what each choice of the paper contributes instead, and
write ablation.html, .txt and .json.

examples:
  numpy-cae report --data motions/ -m model.npz -o report
  numpy-cae report --only cmu35 --data cmu35/ -o report
  numpy-cae report --data motions/ --only damage -o report
  numpy-cae report --ablation
"""

import argparse
import json
import time
from glob import escape
from pathlib import Path

import numpy as np

from numpy_cae.cli.shared import arguments, one_motion
from numpy_cae.cli.shared.output import note, working, write_texts
from numpy_cae.experiments import ablation
from numpy_cae.experiments.material import Material, is_test, read_material, synthetic_material
from numpy_cae.experiments.page import page, plain_text
from numpy_cae.experiments.registry import EXPERIMENTS, PUBLISHED, run_experiment
from numpy_cae.experiments.result import Result
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import find_motion_files

ABLATION = (
    "Ablation of holden2015",
    "Each choice of the network and the training of holden2015 is left out or replaced, one at a "
    "time, on the same takes and with the same measures. The networks are smaller than the paper's "
    "and trained for less, so that each can be trained from several seeds.",
)
"""Title and introduction of the page."""
SYNTHETIC_MINUTES, TEST_EVERY = 20.0, 4
"""Without --data: minutes of synthetic takes, of which every fourth is for testing."""
Measured = tuple[dict[str, Result], dict[str, str]]
"""Results by name, and what must be known to judge or to reproduce them."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The motions, the model, the folder and the experiments."""
    add, names = parser.add_argument, tuple(EXPERIMENTS)
    add("--data", **arguments.FOLDERS, help="folders of motion files")
    model = "model file from `numpy-cae train --test PATTERN` (default: the starter model)"
    add("-m", "--model", type=Path, help=model)
    output = "folder to write, created if it does not exist (default: report or ablation)"
    add("-o", "--output", **arguments.FOLDER, help=output)
    test = "names of the test files, where the model does not record them (default for the "
    test += "starter model, for data that it has not seen: every fifth file)"
    add("--test", **arguments.PATTERNS, help=test)
    unseen = "the model has seen none of these files: test on --test or on every fifth file"
    add("--unseen", **arguments.FLAG, help=unseen)
    only, every = f"run only these, of {', '.join(names)} (the default)", (*names, *PUBLISHED)
    only += f" and {', '.join(PUBLISHED)}"
    add("--only", nargs="+", choices=every, default=names, metavar="NAME", help=only)
    arguments.add_shared(parser, "seed mapping unit up floor")
    add = parser.add_argument_group("ablation").add_argument
    compare = "train and compare networks of other depth, unpooling, training, … instead "
    compare += f"(default: on {SYNTHETIC_MINUTES:g} minutes of synthetic motions)"
    add("--ablation", **arguments.FLAG, help=compare)
    seeds = f"number of seeds that each row is trained from (default: {ablation.SEEDS})"
    add("--seeds", **arguments.COUNT, default=ablation.SEEDS, help=seeds)


def run(args: argparse.Namespace) -> int:
    """Read, measure, write."""
    started = time.monotonic()
    name = "ablation" if args.ablation else "report"
    args.output = args.output or Path(name)
    results, provenance = (_ablation if args.ablation else _experiments)(args)
    provenance["made by"] += f", {time.monotonic() - started:.0f} s"
    html = page(results, provenance, *(ABLATION if args.ablation else ()))
    text = plain_text(results.values(), provenance)
    data = {"provenance": provenance, "results": {n: r.data() for n, r in results.items()}}
    as_json = json.dumps(data, indent=1, ensure_ascii=False, default=lambda value: value.item())
    texts = {f"{name}.html": html, f"{name}.txt": text, f"{name}.json": as_json}
    write_texts(args.output, texts)
    confirmed = sum(result.confirmed for result in results.values())
    claims = sum(len(result.claims) for result in results.values())
    print(f"{args.output / name}.html: {confirmed} of {claims} claims confirmed")
    return 0


def _experiments(args: argparse.Namespace) -> Measured:
    """Run the experiments of --only."""
    if not args.data:
        raise ValueError("give --data (only --ablation does without)")
    data = ", ".join(folder.name for folder in args.data)
    inputs: dict[str, tuple] = {}
    provenance = {"data": data}
    if any(name in EXPERIMENTS for name in args.only):
        manifold, material, provenance = _read(args, data)
        inputs = {name: (manifold, material) for name in EXPERIMENTS if name in args.only}
    inputs |= {name: (args.data,) for name in PUBLISHED if name in args.only}
    args.output.mkdir(parents=True, exist_ok=True)
    results: dict[str, Result] = {}
    for number, name in enumerate(inputs, start=1):
        note(f"[{number}/{len(inputs)}] {name} …")
        with working(name):
            result = results[name] = run_experiment(name, *inputs[name], seed=args.seed)
        counted = f"{result.confirmed} of {len(result.claims)} claims confirmed"
        note(f"{name}: {counted if result.claims else result.note}")
    return results, provenance | {"made by": f"NumPy {np.__version__}, seed {args.seed}"}


def _ablation(args: argparse.Namespace) -> Measured:
    """Train and compare the networks of the ablation."""
    if args.data and not args.test:
        raise ValueError("--data needs the takes to hold out: --test PATTERN")
    if args.data:
        material = read_material(args.data, args.test, *arguments.reading(args))
    else:
        material = synthetic_material(SYNTHETIC_MINUTES, TEST_EVERY)
    args.output.mkdir(parents=True, exist_ok=True)
    started, rows = time.monotonic(), ablation.all_rows()
    evaluation = ablation.Evaluation(material)

    def progress(line: str) -> None:
        note(f"{time.monotonic() - started:.0f} s, {line}")

    ablation.measure_rows(evaluation, rows, args.seeds, progress)
    folders = ", ".join(folder.name for folder in args.data or [Path("data_synth")])
    provenance = {
        "data": f"{folders}: {len(material.training)} takes to learn from "
        f"({len(evaluation.windows)} windows), {len(material.testing)} to test",
        "test takes": " ".join(args.test) or f"every {TEST_EVERY}th",
        "made by": f"NumPy {np.__version__}, seeds 0 to {args.seeds - 1}",
    }
    return {"ablation": ablation.ablation_result(rows, evaluation.sample)}, provenance


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
        "training": str(settings("schedule", "")),
    }
    return manifold, material, {name: text for name, text in provenance.items() if text}


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
