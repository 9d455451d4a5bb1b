"""`numpy-cae report --ablation`: the contribution of each choice of holden2015, on one page."""

import argparse
import time
from pathlib import Path

import numpy as np

from numpy_cae.cli.shared import arguments
from numpy_cae.cli.shared.output import note, write_texts
from numpy_cae.experiments.ablation import choices
from numpy_cae.experiments.ablation.ablation import Evaluation, ablation_result, measure_rows
from numpy_cae.experiments.material import Material, read_material, synthetic_material
from numpy_cae.experiments.page import page, plain_text

OUTPUT = Path("ablation")
SYNTHETIC_MINUTES, TEST_EVERY = 20.0, 4
"""Without --data: minutes of synthetic takes, of which every fourth is for testing."""
TITLE = "Ablation of holden2015"
INTRODUCTION = (
    "Each choice of the network and the training of holden2015 is left out or replaced, one at a "
    "time, on the same takes and with the same measures. The networks are smaller than the paper's "
    "and trained for less, so that each can be trained from several seeds."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the ablation, which also uses --data, --test and -o."""
    add = parser.add_argument_group("ablation").add_argument
    ablation = (
        "train and compare networks of other depth, unpooling, training, … instead (default: on "
        f"{SYNTHETIC_MINUTES:g} minutes of synthetic motions, into {OUTPUT}/)"
    )
    add("--ablation", **arguments.FLAG, help=ablation)
    seeds = f"number of seeds that each row is trained from (default: {choices.SEEDS})"
    add("--seeds", **arguments.COUNT, default=choices.SEEDS, help=seeds)
    width = f"filters of the lowest of three layers; the paper has 64 (default: {choices.WIDTH})"
    add("--width", **arguments.COUNT, default=choices.WIDTH, help=width)
    pair = {"type": arguments.whole_number, "nargs": 2, "metavar": ("LAYER", "FINE")}
    default = (choices.LAYER_EPOCHS, choices.FINE_EPOCHS)
    epochs = "epochs of each layer and of fine tuning (default: {} {})".format(*default)
    add("--epochs", **pair, default=default, help=epochs)


def run(args: argparse.Namespace) -> int:
    """Read or synthesise the takes, train, measure and write."""
    started = time.monotonic()
    material = material_of(args)
    output = args.output or OUTPUT
    output.mkdir(parents=True, exist_ok=True)

    def progress(line: str) -> None:
        note(f"{time.monotonic() - started:.0f} s, {line}")

    networks = choices.choices(args.width, *args.epochs)
    evaluation = Evaluation(material)
    rows = measure_rows(evaluation, networks, args.seeds, progress)
    seconds = time.monotonic() - started
    result = ablation_result(rows, evaluation.sample)
    folders = ", ".join(folder.name for folder in args.data or [Path("data_synth")])
    stages = networks[0].schedule
    how = {
        "data": f"{folders}: {len(material.training)} takes to learn from "
        f"({len(evaluation.windows)} windows), {len(material.testing)} to test",
        "test takes": " ".join(args.test) or f"every {TEST_EVERY}th",
        "made by": f"NumPy {np.__version__}, seeds 0 to {args.seeds - 1}, {seconds:.0f} s",
    }
    settings = vars(stages.layer), vars(stages.fine_tuning)
    how |= describe(list(networks[0].filters), choices.TAPS, *settings)
    html, text = page({"ablation": result}, how, TITLE, INTRODUCTION), plain_text([result], how)
    write_texts(output, {"ablation.html": html, "ablation.txt": text})
    print(
        f"{output / 'ablation.html'}: {result.confirmed} of {len(result.claims)} claims confirmed"
    )
    return 0


def material_of(args: argparse.Namespace) -> Material:
    """The takes of --data, those of --test held out, or synthetic ones."""
    if args.data and not args.test:
        raise ValueError("--data needs the takes to hold out: --test PATTERN")
    if args.data:
        return read_material(args.data, args.test, *arguments.reading(args))
    return synthetic_material(SYNTHETIC_MINUTES, TEST_EVERY)


def describe(filters: list[int], taps: int, layer: dict, fine_tuning: dict) -> dict[str, str]:
    """A network and its training in words, for the provenance of a page."""
    return {
        "network": f"{' + '.join(map(str, filters))} filters of {taps} frames",
        "layers": _listed(layer),
        "fine tuning": _listed(fine_tuning),
    }


def _listed(settings: dict) -> str:
    """The settings of a stage that have a value, on one line."""
    return ", ".join(
        f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}"
        for key, value in settings.items()
        if value is not None
    )
