"""`numpy-cae report --ablation`: which choices of holden2015 earn what they cost, on one page."""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from data_synth import plan_takes
from numpy_cae.atomic_write import atomic_write
from numpy_cae.cli import arguments as kinds
from numpy_cae.experiments.ablation.ablation import SEEDS, ablation
from numpy_cae.experiments.ablation.choices import (
    FINE_EPOCHS,
    LAYER_EPOCHS,
    TAPS,
    WIDTH,
    Choice,
    choices,
)
from numpy_cae.experiments.ablation.evaluation import Evaluation
from numpy_cae.experiments.ablation.result import Ablation
from numpy_cae.experiments.material import LabelledTake, Material, read_material
from numpy_cae.experiments.page import page, plain_text
from numpy_cae.experiments.section import Section
from numpy_cae.motion import body_of
from numpy_cae.motion.retarget.to_body import RATE

OUTPUT = Path("ablation")
SYNTHETIC_MINUTES, HELD_OUT = 20.0, 4
"""Without --data: minutes of synthetic takes, every fourth of which is held out."""
TITLE = "What each choice of the paper is worth"
INTRODUCTION = (
    "holden2015 wishes to “thoroughly evaluate our work against alternative methods and justify "
    "the effectiveness of using a deep architecture”. Here every choice of its network and its "
    "training is left out or replaced, one at a time, on the same takes and with the same "
    "measures. The networks are smaller than the paper's and trained for less, so that each can be "
    "trained from several seeds."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `--ablation` takes beside --data, --test and -o."""
    group = parser.add_argument_group("the ablation, a page of its own")
    add = group.add_argument
    add(
        "--ablation",
        action="store_true",
        help="train and compare networks of other depth, sparsity, pooling, … instead, which "
        f"needs no model; without --data on {SYNTHETIC_MINUTES:g} minutes of synthetic motions, "
        f"without -o into {OUTPUT}/. What is measured is kept there, and a run that was cut off "
        "goes on",
    )
    number = kinds.positive_number
    add("--seeds", type=number, default=SEEDS, metavar="N", help=f"a row (default: {SEEDS})")
    add(
        "--width",
        type=number,
        default=WIDTH,
        metavar="N",
        help=f"filters of the lowest of three layers; the paper has 64 (default: {WIDTH})",
    )
    add(
        "--epochs",
        type=kinds.whole_number,
        nargs=2,
        default=(LAYER_EPOCHS, FINE_EPOCHS),
        metavar=("LAYER", "FINE"),
        help="of a layer, of fine tuning; the paper has 25 of a layer (default: "
        f"{LAYER_EPOCHS} {FINE_EPOCHS})",
    )


def run(args: argparse.Namespace) -> int:
    """Read or make, train, measure, write."""
    started = time.monotonic()
    if args.data and not args.test:
        raise ValueError("--ablation with --data needs the takes to hold out: --test PATTERN")
    material = _read(args) if args.data else _synthetic()
    output = args.output or OUTPUT
    output.mkdir(parents=True, exist_ok=True)
    evaluation = Evaluation(material)
    chosen = choices(args.width, *args.epochs)
    kept = output / "ablation.json"
    found = ablation(evaluation, chosen, args.seeds, kept, lambda line: _say(line, started))
    seconds = time.monotonic() - started
    section = _section(found, seconds)
    how = _provenance(material, evaluation, chosen, args, seconds)
    for name, text in (
        ("ablation.html", page([section], how, TITLE, INTRODUCTION)),
        ("ablation.txt", plain_text([section], how)),
    ):
        with atomic_write(output / name) as beside:
            beside.write_text(text, encoding="utf-8")
    print(f"{output / 'ablation.html'}: {section.held} of {len(section.findings)} claims held")
    return 0


def _read(args: argparse.Namespace) -> Material:
    return read_material(args.data, args.test, kinds.chosen_mapping(args), args.unit)


def _synthetic() -> Material:
    halves: tuple[list[LabelledTake], list[LabelledTake]] = ([], [])
    for plan in plan_takes(SYNTHETIC_MINUTES):
        take = plan.make(RATE)
        positions = body_of(take.motion)
        halves[plan.number % HELD_OUT == 0].append(
            LabelledTake(Path(plan.name), positions, "synthetic", take.kind, take.style)
        )
    return Material(*halves)


def _say(line: str, started: float) -> None:
    print(f"{time.monotonic() - started:.0f} s, {line}", file=sys.stderr, flush=True)


def _section(found: Ablation, seconds: float) -> Section:
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder, "picture.png")
        found.save_picture(picture)
        drawn = picture.read_bytes()
    findings = found.findings()
    return Section("ablation", found.title, found.text(), findings, drawn, seconds=seconds)


def _provenance(
    material: Material,
    evaluation: Evaluation,
    chosen: Sequence[Choice],
    args: argparse.Namespace,
    seconds: float,
) -> dict[str, str]:
    layer, fine = chosen[0].schedule.layer, chosen[0].schedule.fine_tuning
    folders = ", ".join(folder.name for folder in args.data or [])
    return {
        "data": f"{folders or 'synthetic, data_synth'}: {len(material.training)} takes to learn "
        f"from ({len(evaluation.windows)} windows), {len(material.testing)} to test",
        "test takes": " ".join(args.test) or f"every {HELD_OUT}th",
        "network": f"{' + '.join(map(str, chosen[0].filters))} filters of {TAPS} frames",
        "layers": _words(layer),
        "fine tuning": _words(fine),
        "made by": f"NumPy {np.__version__}, seeds 0 to {args.seeds - 1}, {seconds:.0f} s for what "
        "was not measured before",
    }


def _words(stage: object) -> str:
    return ", ".join(
        f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}"
        for key, value in vars(stage).items()
        if value is not None
    )
