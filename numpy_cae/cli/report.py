"""Run every experiment of holden2015, section 7, on the takes that the model was not trained on.
Write report.html (one self-contained page: each claim, whether it held, tables and pictures) and
report.txt. With --ablation, measure what each choice of the paper contributes instead.

examples:
  numpy-cae report --data motions/ -m model.npz -o report
  numpy-cae report --ablation
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

from numpy_cae.cli import ablation, one_motion
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli.output import print_json, write_texts
from numpy_cae.experiments.material import Material, read_material
from numpy_cae.experiments.page import page, plain_text
from numpy_cae.experiments.section import EXPERIMENTS, run_section
from numpy_cae.manifold import MotionManifold


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The motions, the model, the folder and the experiments."""
    add, names = parser.add_argument, tuple(EXPERIMENTS)
    add("--data", **kinds.FOLDERS, help="folders of motion files")
    add("-m", "--model", type=Path, help="model file from `numpy-cae train --test PATTERN`")
    output = "folder to write, created if it does not exist"
    add("-o", "--output", **kinds.FOLDER, help=output)
    test = "names of the test files, where the model does not record them"
    add("--test", **kinds.PATTERNS, help=test)
    only = f"run only these experiments, of {', '.join(names)}"
    add("--only", nargs="+", choices=names, default=names, metavar="NAME", help=only)
    kinds.add_shared(parser, "seed json mapping unit")
    ablation.add_arguments(parser)


def run(args: argparse.Namespace) -> int:
    """Read, measure, write."""
    if args.ablation:
        return ablation.run(args)
    missing = [name for name in ("data", "model", "output") if getattr(args, name) is None]
    if missing:
        raise ValueError(f"needs {', '.join(f'--{name}' for name in missing)}, or --ablation")
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
    html, text = page(sections, how), plain_text(sections, how)
    write_texts(args.output, {"report.html": html, "report.txt": text})
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
        "layers": ablation.listed(schedule.get("layer", {})),
        "fine tuning": ablation.listed(schedule.get("fine_tuning", {})),
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
