"""The files of a command: its model, the motions that it reads, takes to train and to test on, and
the files that it writes."""

import argparse
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Sized
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from numpy_cae.atomic_write import require_place
from numpy_cae.cli.shared import arguments
from numpy_cae.cli.shared.output import note, with_progress
from numpy_cae.manifold import (
    ModelFileError,
    MotionManifold,
    SequenceManifold,
    load_manifold,
    starter,
)
from numpy_cae.manifold.model_file import Manifold
from numpy_cae.mocap import require_bvh, write_bvh
from numpy_cae.mocap.bodies import Problem, read_body, read_files, split_takes
from numpy_cae.mocap.file_motion import KEPT_SUFFIXES
from numpy_cae.mocap.load import find_motion_files
from numpy_cae.motion import RATE, Motion
from numpy_cae.viz import Actor, save_viewer


def add_model_arguments(parser: argparse.ArgumentParser) -> None:
    """The model, and how motion files are read."""
    model = "model file from `numpy-cae train` (default: the starter model of the package)"
    parser.add_argument("-m", "--model", type=Path, help=model)
    arguments.add_shared(parser, "mapping unit up floor")


def add_output_arguments(parser: argparse.ArgumentParser) -> None:
    """The motion file to write, and the page."""
    parser.add_argument("-o", "--output", type=Path, required=True, help="motion file, .bvh")
    arguments.add_shared(parser, "overwrite html")


def load_model(args: argparse.Namespace) -> MotionManifold:
    """The convolutional model that `--model` names, by default the starter model.

    Raises ModelFileError if there is no such file, or if the model is sequential.
    """
    manifold = load_any_model(args)
    if isinstance(manifold, SequenceManifold):
        raise ModelFileError(f"{args.model}: not a convolutional, but a sequential manifold")
    return manifold


def load_any_model(args: argparse.Namespace) -> Manifold:
    """The model that `--model` names, by default the starter model; ModelFileError if there is no
    such file."""
    if not args.model:
        return starter()
    if not args.model.exists():
        raise ModelFileError(f"{args.model}: no such file; leave -m out for the starter model")
    return load_manifold(args.model)


def write(motion: Motion, path: Path) -> None:
    """Write a motion and print what was written."""
    write_bvh(motion, path)
    print(f"{path}: {motion}")


def write_page(output: Path, content: str, actors: list[Actor], **shown: Any) -> None:
    """Write a page beside the output that plays motions at thirty frames a second; `shown` is as in
    `save_viewer`."""
    page = output.with_suffix(".html")
    save_viewer(actors, page, RATE, f"{output.stem}: {content}", **shown)
    print(f"{page}: {content}; open it in a browser")


def named_files(paths: Iterable[Path]) -> dict[Path, Path]:
    """The motion files that are named or are in a folder that is named, each with its path below
    that folder."""
    names: dict[Path, Path] = {}
    for path in paths:
        below = path if path.is_dir() else path.parent
        sources = find_motion_files(path) if path.is_dir() else [path]
        names |= {source: source.relative_to(below) for source in sources}
    return names


def is_single(args: argparse.Namespace) -> bool:
    """Whether one file is named, and no folder."""
    return len(args.files) == 1 and not args.files[0].is_dir()


def targets_of(args: argparse.Namespace) -> dict[Path, Path | None]:
    """Each file to read with the file to write, None in a dry run.

    Raises ValueError if a file cannot be written, two would be written in one place, or a file
    would be lost.
    """
    names = named_files(args.files)
    if args.dry_run:
        return dict.fromkeys(names)
    if args.output is None:
        raise ValueError("name the file or folder to write with -o, or use --dry-run")
    targets = {source: _target(args, source, name) for source, name in names.items()}
    require_one_target_each(targets)
    if args.html:
        pages = {source: target.with_suffix(".html") for source, target in targets.items()}
        index = {} if is_single(args) else {Path("the index"): args.output / "index.html"}
        require_one_target_each(pages | index)
    if not args.overwrite:
        for source, target in targets.items():
            _require_version(target, source)
    return dict(targets)


def _target(args: argparse.Namespace, source: Path, name: Path) -> Path:
    """The file to write for a file whose path below its folder is `name`."""
    output = args.output
    is_kept = source.suffix.lower() in KEPT_SUFFIXES
    if is_single(args) and not output.is_dir():
        if not (is_kept and source.suffix.lower() == output.suffix.lower()):
            require_bvh(output)
        return output
    if output.suffix.lower() in KEPT_SUFFIXES and not output.is_dir():
        raise ValueError(f"{output}: is a file's name, expected a folder for the motions")
    return output / (name if is_kept else f"{name}.bvh")


def require_one_target_each(targets: Mapping[Path, Path]) -> None:
    """Raise ValueError if two sources would be written to one file."""
    sources: dict[Path, Path] = {}
    for source, target in targets.items():
        first = sources.setdefault(target, source)
        if first != source:
            problem = f"{source} and {first} would both be written to {target}"
            raise ValueError(f"{problem}: give their folder, or write them to different folders")


def _require_version(path: Path, source: Path) -> None:
    """Raise ValueError if a file exists and most of its lines are not lines of the source, as those
    of an earlier repair are; or if it is the source."""
    if not path.exists():
        return
    require_place(path)  # a pipe would be waited for
    arguments.require_not_read(path, [source])
    if not _has_lines_of(path.read_bytes().splitlines(), source.read_bytes().splitlines()):
        problem = f"exists and is no version of {source}; --overwrite replaces it"
        raise ValueError(f"{path}: {problem}")


def is_version(path: Path, source: Path) -> bool:
    """Whether most frames of a file that may be replaced are frames of the source.

    Other motions of the rig have lines of the source, too: those of its hierarchy. Earlier results
    of --project or --smooth have no frame of it; they are replaced by the same bytes only.
    """
    return _has_lines_of(_lines_of_frames(path), _lines_of_frames(source))


def _lines_of_frames(path: Path) -> list[bytes]:
    """The lines of a motion file after the hierarchy, if it has one, without those of one word,
    such as the number of a frame in an Acclaim file."""
    frames = re.split(rb"(?i)frame time:", path.read_bytes())[-1]
    return [line for line in frames.splitlines() if len(line.split(None, 1)) > 1]


def _has_lines_of(lines: list[bytes], source: list[bytes]) -> bool:
    """Whether most of the lines are lines of the source."""
    source_lines = set(source)
    return 2 * sum(line in source_lines for line in lines) > len(lines)


Take = TypeVar("Take", bound=Sized)


def read_bodies(
    args: argparse.Namespace, paths: Sequence[Path], strict: bool = False
) -> Iterator[tuple[Path, np.ndarray]]:
    """Each file that can be used, as twenty joints at 30 frames a second, (F, 20, 3) in metres;
    prints what is in doubt, and at the end how many files are odd."""
    changed = 0
    read = partial(read_body, **arguments.reading(args))
    for path, (positions, notes) in read_usable(paths, read, strict):
        yield path, positions
        changed += len(notes) > 1
        for doubt in notes:
            if doubt.in_doubt:
                note(f"{path}: {doubt.text}")
    if changed:
        change = "were turned, moved to a floor at 0 or are odd in another way"
        note(f"{changed} files {change}; see `numpy-cae rig FILE`")


def split_for_test(
    takes: Iterable[tuple[Path, Take]], test: Sequence[str], rate: float
) -> tuple[list[Take], list[Take]]:
    """The takes to train on, and those to test on, whose file's name matches a pattern in `test`.

    Says how many there are; `rate` is their frames a second. Raises ValueError if a pattern matches
    no take, or none is left to train on.
    """
    training, testing = split_takes(takes, test)
    minutes = sum(map(len, training)) / rate / 60
    advice = ", less than 10 is little to learn from" if minutes < 10 else ""
    note(
        f"{len(training)} takes to train on ({minutes:.1f} min{advice}), {len(testing)} to test on"
    )
    return training, testing


def read_usable(
    paths: Sequence[Path], read: Callable[[Path], Take], strict: bool = False
) -> Iterator[tuple[Path, Take]]:
    """Each file that `read` can read, and what `read` makes of it. A file that cannot be used is an
    error if `strict` or if it is the only one, otherwise it is reported and skipped; ValueError if
    all are."""
    left_out = 0
    takes = with_progress(read_files(paths, read), len(paths), "file")
    for path, take in zip(paths, takes, strict=True):
        if not isinstance(take, Problem):
            yield path, take
        elif strict or len(paths) == 1:
            raise take
        else:
            left_out += 1
            note(f"left out: {take}")
    if left_out == len(paths):
        raise ValueError(f"none of {left_out} files can be used, see above")
