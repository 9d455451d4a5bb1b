"""`numpy-cae report --data FOLDER -m model.npz -o report/`: every claim, measured, on one page.

With `--ablation` another page instead: see `numpy_cae.cli.ablation`.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.cli import ablation
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli.as_json import add_json_argument, print_json
from numpy_cae.experiments.material import Material, read_material
from numpy_cae.experiments.page import page, plain_text
from numpy_cae.experiments.reported import ALONE, REPORTED
from numpy_cae.experiments.section import Section, run_section
from numpy_cae.manifold import MotionManifold, load_manifold

_THREADS = "OPENBLAS_NUM_THREADS"


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Motions and a model in, a page out."""
    parser = subparsers.add_parser(
        "report",
        help="run every experiment and write one page of what held",
        description="Run every experiment of holden2015, section 7, on the takes that the model "
        "was not trained on, and write report.html (one self-contained page: each claim, our "
        "table, our picture, whether it held) and report.txt.",
        epilog="example: numpy-cae report --data motions/ -m model.npz -o report; which of the "
        "paper's choices earn what they cost: numpy-cae report --ablation",
    )
    add = parser.add_argument
    add("--data", type=Path, nargs="+", metavar="FOLDER", help="motion files")
    add("-m", "--model", type=Path, help="from `numpy-cae train --test PATTERN`")
    add("-o", "--output", type=Path, metavar="FOLDER", help="made if missing")
    add(
        "--test",
        nargs="+",
        metavar="PATTERN",
        default=[],
        help="files that the model was not trained on; only for models that do not say so "
        "themselves",
    )
    add(
        "--only",
        nargs="+",
        choices=tuple(REPORTED),
        default=list(REPORTED),
        metavar="NAME",
        help=f"run these alone, of {', '.join(REPORTED)}",
    )
    add("--seed", type=kinds.whole_number, default=0, help="of everything drawn (default: 0)")
    cores = min(2, os.cpu_count() or 1)
    add(
        "--processes",
        type=kinds.positive_number,
        default=cores,
        metavar="N",
        help=f"experiments at a time (default: {cores})",
    )
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
    started = time.monotonic()
    manifold = load_manifold(args.model)
    patterns = _test_patterns(manifold, args)
    print(f"reading {', '.join(map(str, args.data))}", file=sys.stderr, flush=True)
    material = read_material(args.data, patterns, kinds.chosen_mapping(args), args.unit)
    if not material.testing or not material.training:
        which = "test" if not material.testing else "learn from"
        raise ValueError(f"--data holds no take to {which}: the test takes are {patterns}")
    args.output.mkdir(parents=True, exist_ok=True)
    seconds = time.monotonic() - started
    print(
        f"{len(material.training)} takes to fit baselines to, {len(material.testing)} to test, "
        f"read in {seconds:.0f} s",
        file=sys.stderr,
        flush=True,
    )
    names = [name for name in REPORTED if name in args.only]
    sections = {}
    for section in _sections(names, manifold, material, args):
        sections[section.name] = section
        said = f"[{len(sections)}/{len(names)}] {section.summary()}"
        print(said, file=sys.stderr, flush=True)
    ordered = [sections[name] for name in names]
    how = provenance(manifold, material, patterns, args, time.monotonic() - started)
    for name, text in (
        ("report.html", page(ordered, how)),
        ("report.txt", plain_text(ordered, how)),
    ):
        with atomic_write(args.output / name) as beside:
            beside.write_text(text, encoding="utf-8")
    claims = sum(len(section.findings or []) for section in ordered)
    held = sum(section.held for section in ordered)
    if args.json:
        told = [_told(section) for section in ordered]
        print_json({"held": held, "claims": claims, "how": how, "experiments": told})
    else:
        print(f"{args.output / 'report.html'}: {held} of {claims} claims held")
    return 0


def _told(section: Section) -> dict:
    """A section without its pictures."""
    return {
        "name": section.name,
        "title": section.title,
        "failure": section.failure or None,
        "claims": section.findings or [],
        "text": section.text,
        "seconds": section.seconds,
    }


def _test_patterns(manifold: MotionManifold, args: argparse.Namespace) -> list[str]:
    """Which files the model was not trained on: what it says itself, or --test where it is mute."""
    own = list(manifold.settings.get("test") or [])
    if own and args.test and sorted(own) != sorted(args.test):
        raise ValueError(
            f"{args.model} was trained without {' '.join(own)}: other test takes, {args.test}, "
            "may be ones that it has seen. Leave --test out"
        )
    if not (own or args.test):
        raise ValueError(
            f"{args.model} does not say which takes it was not trained on: name them with --test, "
            "such as --test '*_005.bvh'"
        )
    return own or args.test


def _sections(
    names: Sequence[str], manifold: MotionManifold, material: Material, args: argparse.Namespace
) -> Iterator[Section]:
    """Each section as it is done: several at a time, then those that must run alone."""
    together = [name for name in names if name not in ALONE]
    if args.processes == 1 or len(together) < 2:
        yield from (run_section(name, manifold, material, args.seed) for name in together)
    else:
        yield from _side_by_side(together, material, args)
    for name in (name for name in names if name in ALONE):
        yield run_section(name, manifold, material, args.seed)


def _side_by_side(
    names: Sequence[str], material: Material, args: argparse.Namespace
) -> Iterator[Section]:
    before = os.environ.get(_THREADS)
    os.environ[_THREADS] = "1"  # the processes share out the cores, read when they import NumPy
    try:
        pool = ProcessPoolExecutor(
            min(args.processes, len(names)),
            mp_context=multiprocessing.get_context("spawn"),
            initializer=_begin,
            initargs=(args.model, material, args.seed),
        )
        with pool:
            for done in as_completed([pool.submit(_work, name) for name in names]):
                yield done.result()
    except BrokenProcessPool:
        raise ValueError(
            "a process that ran experiments was ended from outside, perhaps for lack of memory: "
            "try --processes 1"
        ) from None
    finally:
        if before is None:
            del os.environ[_THREADS]
        else:
            os.environ[_THREADS] = before


_given: dict = {}  # of a process of the pool: what all of its experiments are run on


def _begin(model: Path, material: Material, seed: int) -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it; what to say is its parent's part
    _given.update(manifold=load_manifold(model), material=material, seed=seed)


def _work(name: str) -> Section:
    return run_section(name, **_given)


def provenance(
    manifold: MotionManifold,
    material: Material,
    patterns: Sequence[str],
    args: argparse.Namespace,
    seconds: float,
) -> dict[str, str]:
    """What must be known to judge the figures, or to get them again."""
    settings = manifold.settings
    schedule = settings.get("schedule", {})
    seen = settings.get("takes")
    told = {
        "model": f"{args.model.name}, learned from {seen} takes, {settings.get('windows')} windows "
        f"of {settings.get('window')} frames, seed {settings.get('seed')}",
        "network": f"{' + '.join(str(layer.b.size) for layer in manifold.network.layers)} filters "
        f"of {len(manifold.network.layers[0].w)} frames",
        "layers": _words(schedule.get("layer", {})),
        "fine tuning": _words(schedule.get("fine_tuning", {})),
        "data": f"{', '.join(folder.name for folder in args.data)}: {len(material.training)} takes "
        f"to fit baselines to, {len(material.testing)} to test",
        "test takes": f"{' '.join(patterns)}, by take, never trained on or fitted to",
        "made by": f"NumPy {np.__version__}, seed {args.seed}, {seconds:.0f} s with "
        f"{args.processes} experiments at a time",
    }
    if settings.get("folders"):
        told["learned from"] = ", ".join(
            f"{folder['name']} ({folder['files']} files, {folder['test']} of them kept for testing)"
            for folder in settings["folders"]
        )
    if seen is not None and seen != len(material.training):
        told["note"] = f"the model learned from {seen} takes, --data holds others than those"
    return told


def _words(settings: dict) -> str:
    return ", ".join(f"{key} {value}" for key, value in settings.items())
