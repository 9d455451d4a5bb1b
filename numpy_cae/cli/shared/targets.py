"""Which files a command reads, and which file it writes for each of them."""

import argparse
from collections.abc import Iterable, Mapping
from pathlib import Path

from numpy_cae.mocap.formats.write_bvh import require_bvh
from numpy_cae.mocap.load import KEPT, find_motion_files


def named_files(paths: Iterable[Path]) -> dict[Path, Path]:
    """The motion files that are named or are in a folder that is named, each with its path below
    that folder."""
    names = {}
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
    is_kept = source.suffix.lower() in KEPT
    if is_single(args) and not output.is_dir():
        if not (is_kept and source.suffix.lower() == output.suffix.lower()):
            require_bvh(output)
        return output
    if output.suffix.lower() in KEPT and not output.is_dir():
        raise ValueError(f"{output}: is a file's name, expected a folder for the motions")
    return output / (name if is_kept else f"{name}.bvh")


def require_one_target_each(targets: Mapping[Path, Path]) -> None:
    """Raise ValueError if two sources would be written to one file."""
    sources: dict[Path, Path] = {}
    for source, target in targets.items():
        other = sources.setdefault(target, source)
        if other != source:
            problem = f"{source} and {other} would both be written to {target}"
            raise ValueError(f"{problem}: give their folder, or write them to different folders")


def _require_version(path: Path, source: Path) -> None:
    """Raise ValueError if a file exists and most of its lines are not lines of the source, as those
    of an earlier repair are; or if it is the source."""
    if not path.exists():
        return
    if path.samefile(source):
        raise ValueError(f"{path}: is the file that is read; --overwrite allows this")
    own = set(source.read_bytes().splitlines())
    lines = path.read_bytes().splitlines()
    if 2 * sum(line in own for line in lines) <= len(lines):
        problem = f"exists and is no version of {source}; --overwrite replaces it"
        raise ValueError(f"{path}: {problem}")
