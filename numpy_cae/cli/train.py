"""`numpy-cae train FOLDER -o model.npz`: a folder of motion files to a manifold."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import train_sequential
from numpy_cae.cli.as_json import add_json_argument, print_json
from numpy_cae.cli.one_run import add_arguments as add_run_arguments
from numpy_cae.cli.one_run import one_run, state_of
from numpy_cae.cli.takes import read_takes
from numpy_cae.experiments.material import is_test, unlabelled
from numpy_cae.experiments.repair import figure_1, half_zeroed
from numpy_cae.manifold import learn_manifold, save_manifold
from numpy_cae.manifold.learning import RMS
from numpy_cae.motion import find_motion_files
from numpy_cae.motion.io.cache import default_cache, is_worthwhile
from numpy_cae.motion.windows import LENGTH, OVERLAP
from numpy_cae.training import Checkpoint, Schedule, Stage

PAPER = Schedule()


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Every number of holden2015, sections 4 to 6, as an option with the paper's default."""
    parser = subparsers.add_parser(
        "train",
        help="learn a manifold from folders of motion files",
        description="Learn a manifold from every motion file (.bvh, .amc, exponential-map .txt) in "
        "one or more folders. The defaults are those of holden2015.",
        epilog="example: numpy-cae train motions/ -o model.npz --test '*_005.bvh'",
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    parser.add_argument(
        "folders",
        type=Path,
        nargs="+",
        metavar="FOLDER",
        help="motion files, in folders of any depth",
    )
    parser.add_argument("-o", "--output", type=Path, required=True, help="the model file to write")
    parser.add_argument(
        "--test",
        metavar="PATTERN",
        nargs="+",
        default=[],
        help="keep files of such names out and measure on them",
    )
    parser.add_argument(
        "--picture", type=Path, metavar="PNG", help="with --test: draw figure 1 of a test take"
    )
    kinds.add_motion_arguments(parser)
    _add_network_arguments(parser)
    _add_schedule_arguments(parser)
    caching = parser.add_mutually_exclusive_group()
    caching.add_argument(
        "--cache",
        type=Path,
        metavar="FOLDER",
        help="keep what was read of the files, by their content; by default, for 20 MB of files or "
        f"more, in {default_cache()}",
    )
    caching.add_argument("--no-cache", action="store_true", help="read every file anew")
    parser.add_argument(
        "--strict", action="store_true", help="stop at a file that cannot be used, not go on"
    )
    add_run_arguments(parser)
    add_json_argument(parser)
    parser.add_argument("--quiet", action="store_true", help="show no progress")
    parser.add_argument(
        "--model",
        choices=["convolutional", "sequential"],
        default="convolutional",
        help="of holden2015 or of jang2018",
    )
    train_sequential.add_arguments(parser)
    parser.set_defaults(run=lambda args: run(args, parser))


def _add_network_arguments(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--window", type=kinds.positive_number, default=LENGTH, help="frames in a window")
    add("--overlap", type=kinds.whole_number, default=OVERLAP, help="frames shared with the next")
    add("--filters", type=kinds.positive_number, nargs="+", default=[64, 128, 256], help="a layer")
    add("--taps", type=kinds.odd_number, default=15, help="frames that a filter sees")
    add("--bound", type=kinds.bound, default=0.9, help="where arctanh is clipped")
    add("--rms", type=kinds.positive, default=RMS, help="what the features are scaled to")
    add("--seed", type=kinds.whole_number, default=0, help="of everything drawn")


def _add_schedule_arguments(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    layer, fine = PAPER.layer, PAPER.fine_tuning
    add("--epochs", type=kinds.whole_number, default=layer.epochs, help="for each layer")
    add("--rate", type=kinds.rate, default=layer.rate, help="first rate of a layer")
    add("--decay", type=kinds.rate, default=layer.decay, help="of a layer's rate, an epoch")
    add("--alpha", type=kinds.rate, default=layer.alpha, help="weight of sparsity in a layer")
    add("--fine-epochs", type=kinds.whole_number, default=fine.epochs, help="of fine tuning")
    add("--fine-rate", type=kinds.rate, default=fine.rate, help="first rate of fine tuning")
    add("--fine-decay", type=kinds.rate, default=fine.decay, help="of fine tuning's, an epoch")
    add("--fine-alpha", type=kinds.rate, default=fine.alpha, help="sparsity in fine tuning")
    for prefix, stage in (("--", layer), ("--fine-", fine)):
        add(prefix + "batch", type=kinds.positive_number, default=stage.batch, help="of a step")
        add(
            prefix + "zeroed",
            type=kinds.fraction,
            nargs="+",
            default=[stage.zeroed],
            metavar="P",
            help="share of inputs set to zero; two, and each window draws its own between them",
        )
    add("--fine-rescale", action="store_true", help="divide what fine tuning sees by 1 - P")
    add("--fine-momentum", type=kinds.fraction, default=0.0, help="of fine tuning; below 1")


def schedule_of(args: argparse.Namespace) -> Schedule:
    """The schedule that the options describe."""
    zeroed = _zeroed("--zeroed", args.zeroed)
    fine_zeroed = _zeroed("--fine-zeroed", args.fine_zeroed)
    if args.fine_rescale and args.fine_zeroed[-1] == 1:
        raise ValueError("--fine-rescale divides by 1 - P: --fine-zeroed must stay below 1")
    if args.fine_momentum == 1:
        raise ValueError("--fine-momentum 1 would never slow down: it must stay below 1")
    fine = args.fine_epochs, args.fine_rate, args.fine_decay, args.fine_alpha, args.fine_batch
    return Schedule(
        layer=Stage(args.epochs, args.rate, args.decay, args.alpha, args.batch, zeroed),
        fine_tuning=Stage(*fine, fine_zeroed, args.fine_rescale, args.fine_momentum),
    )


def _zeroed(option: str, shares: list[float]) -> float | tuple[float, float]:
    if len(shares) > 2 or shares != sorted(shares):
        raise ValueError(f"{option} takes one share, or the lowest and the highest")
    return shares[0] if len(shares) == 1 else (shares[0], shares[1])


def run(args: argparse.Namespace, parser: argparse.ArgumentParser) -> int:
    """Read, train, save, measure."""
    train_sequential.require_own_options(args, parser)
    if args.picture and not args.test:
        raise ValueError("--picture draws a test take: name the test takes with --test")
    if not args.output.resolve().parent.is_dir():
        raise ValueError(f"there is no folder {args.output.resolve().parent} to write a model to")
    if args.resume and args.output.exists() and not state_of(args.output).exists():
        if args.json:
            print_json({"model": args.output, "settings": None, "test": None})
        else:
            print(f"{args.output}: is whole, there is nothing to go on with")
        return 0
    learn = train_sequential.run if args.model == "sequential" else _run
    with one_run(args.output, args.checkpoint, args.resume) as checkpoint:
        return learn(args, checkpoint)


def _run(args: argparse.Namespace, checkpoint: Checkpoint) -> int:
    mapping = kinds.chosen_mapping(args)
    schedule = schedule_of(args)
    found = {folder: find_motion_files(folder) for folder in args.folders}
    paths = [path for some in found.values() for path in some]
    cache = args.cache
    if cache is None and not args.no_cache and is_worthwhile(paths):
        cache = default_cache()
    training, testing = read_takes(paths, mapping, args.unit, args.test, args.strict, cache)
    manifold = learn_manifold(
        training,
        schedule,
        seed=args.seed,
        window=args.window,
        overlap=args.overlap,
        filters=args.filters,
        taps=args.taps,
        bound=args.bound,
        rms=args.rms,
        show_progress=not args.quiet,
        checkpoint=checkpoint,
    )
    manifold.settings["test"] = args.test
    manifold.settings["folders"] = [
        {"name": folder.resolve().name, "files": len(paths), "test": _count(paths, args.test)}
        for folder, paths in found.items()
    ]
    save_manifold(manifold, args.output)
    checkpoint.remove()
    material = unlabelled(training, testing)
    table = half_zeroed.run(manifold, material) if testing else None
    if args.picture:
        figure_1.run(manifold, material).save_picture(args.picture)
    if args.json:
        test = table.data() if table else None
        print_json({"model": args.output, "settings": manifold.settings, "test": test})
        return 0
    print(f"{args.output}: learned from {manifold.settings['windows']} windows")
    if table:
        print(f"\n{table.text()}")
    if args.picture:
        print(f"\n{args.picture}: figure 1 of the typical test take")
    return 0


def _count(paths: Sequence[Path], patterns: Sequence[str]) -> int:
    return sum(is_test(path, patterns) for path in paths)
