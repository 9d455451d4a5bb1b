"""Change one motion file, or every one in some folders, and report what was changed."""

import argparse
import shutil
from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from numpy_cae.cli.shared import arguments, one_motion
from numpy_cae.cli.shared.output import note, with_progress, working
from numpy_cae.errors import NumpyCaeError
from numpy_cae.experiments.result import text_table
from numpy_cae.manifold import Repaired
from numpy_cae.motion import (
    JOINTS,
    Mappings,
    Motion,
    UnknownRigError,
    body_of,
    find_motion_files,
    load_motion,
    write_like,
    write_motion,
)
from numpy_cae.motion.formats.amc import find_skeleton
from numpy_cae.motion.formats.write import WRITERS, require_writer
from numpy_cae.viz import CORRUPTED, PROJECTED, Actor

Change = Callable[[Motion, Mappings], Repaired]
LIKE = (".bvh", ".amc")
"""Suffixes of files whose text is kept where nothing changed."""
MOST_STRETCHES = 5
HEADER = ("file", "joints", "touched, %", "moved, cm", "at most, cm", "result")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the model, the output and the pictures."""
    add = parser.add_argument
    files = "motion files, or folders that are searched with their subfolders"
    add("files", type=Path, nargs="+", metavar="FILE_OR_FOLDER", help=files)
    output = "file to write, for one motion (its own format keeps the text of what is unchanged; "
    output += "or .bvh, .glb, .npz, .csv); otherwise folder, created if it does not exist"
    add("-o", "--output", type=Path, help=output)
    add("--dry-run", **arguments.FLAG, help="print what would be changed and write nothing")
    add("--overwrite", **arguments.FLAG, help="allow -o to be the file or the folder that is read")
    one_motion.add_model_arguments(parser)
    one_motion.add_pictures(parser, "path of an animation of the motion before and after, overlaid")


def change_files(args: argparse.Namespace, change: Change) -> int:
    """Read, change and write every file; 0 if all could be used, 1 if some, 2 if none."""
    targets = _targets(args)
    if len(targets) == 1 and not args.files[0].is_dir():
        ((source, target),) = targets.items()
        with working(str(source)):
            repaired = _change(args, change, source, target)
        for line in changes(repaired):
            print(f"  {line}")
        return 0
    if args.gif:
        raise ValueError("--gif draws one motion; --html writes a page for each")
    rows, unusable = [], []
    for source, target in with_progress(targets.items(), len(targets), "files done"):
        name = str(source.relative_to(args.files[0])) if args.files[0].is_dir() else source.name
        try:
            rows.append(row(name, _change(args, change, source, target, quiet=True)))
        except (NumpyCaeError, ValueError, OSError) as error:
            unusable.append(str(error))
    print(text_table(HEADER, rows))
    if unusable:
        print(f"\n{len(unusable)} of {len(targets)} files could not be used:")
        print("\n".join(unusable))
    return 0 if not unusable else 1 if rows else 2


def _targets(args: argparse.Namespace) -> dict[Path, Path | None]:
    """Each motion file with the file to write, None in a dry run."""
    single = len(args.files) == 1 and not args.files[0].is_dir()
    found = {}
    for path in args.files:
        for source in find_motion_files(path) if path.is_dir() else [path]:
            found[source] = source.relative_to(path if path.is_dir() else path.parent)
    if args.dry_run:
        return dict.fromkeys(found)
    if args.output is None:
        raise ValueError("name the file or folder to write with -o, or use --dry-run")
    if single and not args.output.is_dir():
        targets = {args.files[0]: args.output}
        if _like(args.files[0], args.output) is False:
            require_writer(args.output)
    else:
        if args.output.suffix.lower() in (*LIKE, *WRITERS) and not args.output.is_dir():
            raise ValueError(f"{args.output}: is a file's name, expected a folder for the motions")
        targets = {
            source: args.output / (name if source.suffix.lower() in LIKE else f"{name}.bvh")
            for source, name in found.items()
        }
        if len(set(targets.values())) < len(targets):
            raise ValueError("several files have one name: give their folder or other outputs")
    for source, target in targets.items():
        if not args.overwrite and target.exists() and target.samefile(source):
            raise ValueError(f"{target}: is the file that is read; --overwrite allows this")
    return targets


def _like(source: Path, target: Path) -> bool:
    return source.suffix.lower() == target.suffix.lower() in LIKE


def _change(
    args: argparse.Namespace, change: Change, source: Path, target: Path | None, quiet: bool = False
) -> Repaired:
    """Change one file."""
    mapping = arguments.chosen_mapping(args)
    motion = load_motion(source, mapping=mapping, **vars(arguments.chosen_coordinates(args)))
    if not quiet:
        note(f"{source}: {len(motion)} frames, {motion.unit_note}")
    try:
        repaired = change(motion, mapping)
    except UnknownRigError as error:
        raise UnknownRigError(f"{source}: {error}") from None
    if target is None:
        return repaired
    if quiet:
        target.parent.mkdir(parents=True, exist_ok=True)
    if _like(source, target):
        write_like(source, motion, repaired.motion, target)
        if target.suffix.lower() == ".amc":
            _copy_skeleton(source, target)
    else:
        write_motion(repaired.motion, target)
    if not quiet:
        one_motion.print_written(repaired.motion, target)
    if args.gif or args.html:
        one_motion.draw(args, target, "before and after", _actors(motion, repaired, mapping), True)
    return repaired


def _copy_skeleton(source: Path, target: Path) -> None:
    """Put the skeleton of an .amc file beside its changed copy."""
    skeleton = find_skeleton(source)
    beside = target.with_name(skeleton.name)
    if not beside.exists():
        shutil.copyfile(skeleton, beside)


def _actors(motion: Motion, repaired: Repaired, mapping: Mappings) -> list[Actor]:
    before, after = body_of(motion, mapping), body_of(repaired.motion, mapping)
    before = before[-len(after) :]
    frames = np.round(repaired.motion.source_frames(one_motion.RATE)).astype(int)
    touched = repaired.touched[np.minimum(frames, len(repaired.touched) - 1)]
    moved = np.linalg.norm(after - before, axis=-1)
    return [
        replace(one_motion.body_actor(before, "before", CORRUPTED), damaged=touched),
        replace(one_motion.body_actor(after, "after", PROJECTED), moved=moved),
    ]


def changes(repaired: Repaired) -> list[str]:
    """A line for joints that were changed in the same frames: names, frames and centimetres."""
    if not repaired.known:
        return [
            f"unlike what the model knows: joints are typically {100 * repaired.residual:.1f} cm "
            "from it; left unchanged (--force repairs it nevertheless)"
        ]
    groups: dict[str, list[int]] = defaultdict(list)
    for joint in np.flatnonzero(repaired.touched.any(axis=0)):
        groups[_frames(repaired.touched[:, joint])].append(joint)
    lines = []
    for frames, joints in groups.items():
        moved = 100 * repaired.moved[:, joints][repaired.touched[:, joints]]
        names = "all joints" if len(joints) == len(JOINTS) else ", ".join(JOINTS[j] for j in joints)
        lines.append(f"{names}: {frames}: moved {moved.mean():.1f} cm, at most {moved.max():.1f}")
    return lines or ["nothing to repair was found"]


def row(name: str, repaired: Repaired) -> list[str]:
    """The cells of a table with `HEADER`; centimetres are those of the touched joints."""
    touched = repaired.touched
    if not repaired.known:
        return [name, "", "", "", "", "unknown motion, unchanged"]
    if not touched.any():
        return [name, "0", "0.0", "", "", "nothing to repair"]
    moved = 100 * repaired.moved[touched]
    share = f"{100 * touched.mean():.1f}"
    joints = str(touched.any(axis=0).sum())
    return [name, joints, share, f"{moved.mean():.1f}", f"{moved.max():.1f}", "repaired"]


def _frames(touched: np.ndarray) -> str:
    """The stretches of frames (F,) bool, such as "frames 30 to 45, 102"."""
    ends = np.flatnonzero(np.diff(touched, prepend=False, append=False)).reshape(-1, 2)
    texts = [f"{a} to {b - 1}" if b - a > 1 else f"{a}" for a, b in ends[:MOST_STRETCHES]]
    more = f" and {len(ends) - MOST_STRETCHES} more" if len(ends) > MOST_STRETCHES else ""
    word = "frame" if len(ends) == 1 and ends[0, 1] - ends[0, 0] == 1 else "frames"
    return f"{word} {', '.join(texts)}{more}"
