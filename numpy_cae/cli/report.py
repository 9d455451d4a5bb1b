"""`numpy-cae report --data FOLDER -m model.npz -o report/`: every experiment on one page.

`--ablation` makes another page: see `numpy_cae.cli.ablation`.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.cli import ablation
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli.as_json import add_json_argument, print_json
from numpy_cae.experiments.section import EXPERIMENTS, run_section

if TYPE_CHECKING:
    from numpy_cae.experiments.material import Material
    from numpy_cae.manifold import MotionManifold


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand."""
    parser = subparsers.add_parser(
        "report",
        help="run every experiment and write a page of the claims that held",
        description="Run every experiment of holden2015, section 7, on the takes that the model "
        "was not trained on. Write report.html (one self-contained page: each claim, whether it "
        "held, tables and pictures) and report.txt.",
        epilog="example: numpy-cae report --data motions/ -m model.npz -o report; to measure what "
        "each choice of the paper contributes: numpy-cae report --ablation",
    )
    add = parser.add_argument
    add("--data", type=Path, nargs="+", metavar="FOLDER", help="folders of motion files")
    add("-m", "--model", type=Path, help="model file from `numpy-cae train --test PATTERN`")
    add("-o", "--output", type=Path, metavar="FOLDER", help="folder to write, made if missing")
    test_help = "names of the test files, where the model does not record them"
    add("--test", nargs="+", metavar="PATTERN", default=[], help=test_help)
    names = tuple(EXPERIMENTS)
    only_help = f"run only these experiments, of {', '.join(names)}"
    add("--only", nargs="+", choices=names, default=names, metavar="NAME", help=only_help)
    add("--seed", type=kinds.whole_number, default=0, help="seed of all random numbers (default 0)")
    add_json_argument(parser)
    kinds.add_motion_arguments(parser)
    ablation.add_arguments(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, measure, write."""
    if args.ablation:
        return ablation.run(args)
    missing = [name for name in ("data", "model", "output") if getattr(args, name) is None]
    if missing:
        raise ValueError(f"needs {', '.join(f'--{name}' for name in missing)}, or --ablation")
    from numpy_cae.cli import one_motion
    from numpy_cae.experiments.material import read_material
    from numpy_cae.experiments.page import page, plain_text

    started = time.monotonic()
    manifold = one_motion.load_model(args, bvh=False)
    patterns = _test_patterns(manifold, args)
    _say(f"reading {', '.join(map(str, args.data))}")
    material = read_material(args.data, patterns, kinds.chosen_mapping(args), args.unit)
    if not (material.testing and material.training):
        which = "learn from" if material.testing else "test"
        raise ValueError(f"--data holds no take to {which}: the test takes are {patterns}")
    args.output.mkdir(parents=True, exist_ok=True)
    _say(_counts(material))
    names, sections = [name for name in EXPERIMENTS if name in args.only], []
    for name in names:
        sections.append(run_section(name, manifold, material, args.seed))
        _say(f"[{len(sections)}/{len(names)}] {sections[-1].summary()}")
    how = _provenance(manifold, material, patterns, args, time.monotonic() - started)
    pages = {"report.html": page(sections, how), "report.txt": plain_text(sections, how)}
    for name, text in pages.items():
        with atomic_write(args.output / name) as beside:
            beside.write_text(text, encoding="utf-8")
    claims = sum(len(section.claims) for section in sections)
    held = sum(section.held for section in sections)
    if args.json:
        experiments = [section.data() for section in sections]
        print_json({"held": held, "claims": claims, "how": how, "experiments": experiments})
    else:
        print(f"{args.output / 'report.html'}: {held} of {claims} claims held")
    return 0


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _test_patterns(manifold: MotionManifold, args: argparse.Namespace) -> list[str]:
    """The patterns of the test files: those that the model records, else --test."""
    own = list(manifold.settings.get("test") or [])
    if own and args.test and sorted(own) != sorted(args.test):
        raise ValueError(
            f"{args.model} was trained without {' '.join(own)}: other test takes, {args.test}, "
            "may be ones that it has seen. Leave --test out"
        )
    if not (own or args.test):
        raise ValueError(
            f"{args.model} does not record which takes it was not trained on: name them with "
            "--test, such as --test '*_005.bvh'"
        )
    return own or args.test


def _provenance(
    manifold: MotionManifold, material: Material, patterns: list[str],
    args: argparse.Namespace, seconds: float,
) -> dict[str, str]:  # fmt: skip
    """What must be known to judge the figures or to reproduce them."""
    settings = manifold.settings
    schedule = settings.get("schedule", {})
    layers = manifold.network.layers
    how = {
        "model": f"{args.model.name}, learned from {settings.get('takes')} takes, "
        f"{settings.get('windows')} windows of {settings.get('window')} frames, "
        f"seed {settings.get('seed')}",
        "network": f"{' + '.join(str(layer.b.size) for layer in layers)} filters of "
        f"{len(layers[0].w)} frames",
        "layers": _listed(schedule.get("layer", {})),
        "fine tuning": _listed(schedule.get("fine_tuning", {})),
        "data": f"{', '.join(folder.name for folder in args.data)}: {_counts(material)}",
        "test takes": f"{' '.join(patterns)}, by take, never trained on or fitted to",
        "made by": f"NumPy {np.__version__}, seed {args.seed}, {seconds:.0f} s",
    }
    if settings.get("folders"):
        how["learned from"] = ", ".join(
            f"{folder['name']} ({folder['files']} files, {folder['test']} of them kept for testing)"
            for folder in settings["folders"]
        )
    return how


def _counts(material: Material) -> str:
    return f"{len(material.training)} takes to fit baselines to, {len(material.testing)} to test"


def _listed(settings: dict) -> str:
    return ", ".join(f"{key} {value}" for key, value in settings.items())
