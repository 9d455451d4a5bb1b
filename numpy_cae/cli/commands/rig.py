"""Print how a motion file is understood: its rig, the names of the twenty joints in the rig, the up
axis, the floor, the unit and the frame rate. With -o, also write the names of the joints to a file,
which can be corrected and given to other commands with --mapping.

examples:
  numpy-cae rig walk.bvh
  numpy-cae rig unknown.bvh -o mapping.json
  numpy-cae repair unknown.bvh -o fixed.bvh --mapping mapping.json
"""

import argparse
import json
from pathlib import Path

from numpy_cae.cli.shared import arguments

TRUSTED = 15
"""TRUSTED: from so many names on that a known rig has too, these names are trusted more than the
suggestion by the hierarchy."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The file, the mapping to write and how the file is read."""
    add = parser.add_argument
    add("file", **arguments.FILE, help="motion file (.bvh, .amc or .txt) to read")
    output = "JSON file to write: our joint names and the rig's"
    add("-o", "--output", type=Path, metavar="JSON", help=output)
    arguments.add_shared(parser, "mapping unit up floor")


def run(args: argparse.Namespace) -> int:
    """Print how the file is understood, and write the mapping."""
    from numpy_cae.atomic_write import atomic_write
    from numpy_cae.mocap import load_motion
    from numpy_cae.mocap.rigs.rigs import match_rig, with_joint_names
    from numpy_cae.mocap.rigs.suggest import suggest_mapping
    from numpy_cae.motion import JOINTS

    mapping, coordinates = arguments.reading(args)
    motion = load_motion(args.file, mapping=mapping, **vars(coordinates))
    rig, by_name = match_rig(with_joint_names(motion.skeleton, mapping))
    own = len(motion.skeleton.names) - motion.skeleton.added
    names = {joint: motion.skeleton.names[at] for joint, at in by_name.items() if at < own}
    indices = match_rig(motion.skeleton)[1]
    if len(indices) < len(JOINTS):
        # If only a few names are those of a known rig, they may mean other joints here.
        suggested = suggest_mapping(motion.skeleton)
        mapping = suggested | names if len(names) >= TRUSTED else names | suggested
        motion = load_motion(args.file, mapping=mapping, **vars(coordinates))
        indices = match_rig(motion.skeleton)[1]
    if indices != by_name or len(names) < TRUSTED:
        rig = f"unknown ({rig} has {len(names)} of the 20 joints)"
    skeleton = motion.skeleton
    joints = len(skeleton.names) - skeleton.added
    unit, *notes = motion.unit_note.split("; ")
    print(
        f"{args.file}: {motion}\nunit   {unit}\nup     {motion.up.upper()}\n"
        f"floor  {motion.floor:.2f} m\nrig    {rig}"
    )
    print("".join(f"note   {note}\n" for note in notes), end="")
    for joint in JOINTS:
        name = skeleton.names[indices[joint]] if joint in indices else "missing: name one"
        guessed = name != names.get(joint) and indices.get(joint, joints) < joints
        print(f"  {joint:15} {name}{' (suggested by the hierarchy: check it)' if guessed else ''}")
    if args.output is not None:
        chosen = {j: skeleton.names[indices[j]] for j in JOINTS if indices.get(j, joints) < joints}
        with atomic_write(args.output) as temporary:
            text = json.dumps(chosen, indent=1, ensure_ascii=False)
            temporary.write_text(text + "\n", encoding="utf-8")
        print(f"{args.output}: {len(chosen)} joints; pass it with --mapping")
    return 0
