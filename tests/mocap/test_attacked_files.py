"""BVH files made by a grammar, with edits that keep most of the structure: read, or refused in a
sentence that names the file.

pytest -m thorough tests/mocap/test_attacked_files.py
"""

import numpy as np
import pytest

from numpy_cae.errors import NumpyCaeError
from numpy_cae.mocap import load_motion

LEGS = "Hip Knee Ankle Toe".split()
ARMS = "Collar Shoulder Elbow Wrist".split()
LENGTHS = {"Hip": 10, "Knee": 42, "Ankle": 40, "Toe": 14}
LENGTHS |= {"Collar": 6, "Shoulder": 14, "Elbow": 28, "Wrist": 24}
ODD_NUMBERS = "nan inf -inf 1e300 1e-320 1,5 0x10 -0 1_000 ٣ 1.#QNAN 99999999999999999999".split()
ODD_WORDS = ["", "{", "}", "JOINT", "End Site", "CHANNELS 7", "MOTION", "Frames: -1", "\ufeff", "é"]
LINE_ENDS = ("\n", "\r\n", "\r", " \n", "\n\n")
BATCH = 250
"""Files of one test."""


def channels(rng, is_root):
    """The channels of a joint, in any order of the axes."""
    rotations = [f"{axis}rotation" for axis in rng.permutation(list("XYZ"))]
    places = [f"{axis}position" for axis in rng.permutation(list("XYZ"))]
    if is_root or rng.random() < 0.1:
        return [*places, *rotations] if rng.random() < 0.8 else [*rotations, *places]
    return rotations


def chain(rng, names, direction, depth):
    """The lines of a limb, and the number of its channels."""
    lines = []
    count = 0
    for number, name in enumerate(names):
        indent = "\t" * (depth + number)
        joint = channels(rng, is_root=False)
        count += len(joint)
        offset = LENGTHS[name[1:]] * direction[number] * rng.uniform(0.8, 1.2)
        lines += [f"{indent}JOINT {name}", indent + "{"]
        lines += [f"{indent}\tOFFSET {' '.join(f'{x:.6g}' for x in offset)}"]
        lines += [f"{indent}\tCHANNELS {len(joint)} {' '.join(joint)}"]
    inner = "\t" * (depth + len(names))
    lines += [f"{inner}End Site", inner + "{", f"{inner}\tOFFSET 0 1 0", inner + "}"]
    lines += ["\t" * (depth + number) + "}" for number in reversed(range(len(names)))]
    return lines, count


def grammatical_file(rng):
    """The lines of a person's BVH file of a few frames."""
    root = channels(rng, is_root=True)
    lines = ["HIERARCHY", "ROOT Hips", "{", "\tOFFSET 0 0 0"]
    lines += [f"\tCHANNELS {len(root)} {' '.join(root)}"]
    count = len(root)
    spine = ["\tJOINT Chest", "\t{", "\t\tOFFSET 0 40 0"]
    spine += ["\t\tCHANNELS 3 Zrotation Xrotation Yrotation"]
    count += 3
    for side, x in (("L", 1.0), ("R", -1.0)):
        out = np.array([x, 0.0, 0.0])
        more, number = chain(rng, [side + name for name in ARMS], [out] * 4, 2)
        spine += more
        count += number
    head = ["\t\tJOINT Head", "\t\t{", "\t\t\tOFFSET 0 25 2"]
    head += ["\t\t\tCHANNELS 3 Zrotation Xrotation Yrotation", "\t\t\tEnd Site", "\t\t\t{"]
    head += ["\t\t\t\tOFFSET 0 10 0", "\t\t\t}", "\t\t}"]
    count += 3
    lines += [*spine, *head, "\t}"]
    down = np.array([0.0, -1.0, 0.0])
    for side, x in (("L", 1.0), ("R", -1.0)):
        directions = [np.array([x, 0.0, 0.0]), down, down, np.array([0.0, -0.3, 1.0])]
        more, number = chain(rng, [side + name for name in LEGS], directions, 1)
        lines += more
        count += number
    frames = int(rng.integers(1, 12))
    lines += [
        "}",
        "MOTION",
        f"Frames: {frames}",
        f"Frame Time: {1 / rng.choice([30, 60, 120]):.7f}",
    ]
    values = rng.normal(scale=20, size=(frames, count))
    lines += [" ".join(f"{value:.4f}" for value in row) for row in values]
    return lines


def edited(lines, rng):
    """The lines after one or two edits: of a word, of a line, or of the end."""
    for _ in range(rng.integers(1, 3)):
        at = int(rng.integers(len(lines)))
        words = lines[at].split(" ")
        kind = rng.integers(6)
        if kind == 0:
            words[rng.integers(len(words))] = str(rng.choice(ODD_NUMBERS))
            lines[at] = " ".join(words)
        elif kind == 1:
            lines[at] = str(rng.choice(ODD_WORDS))
        elif kind == 2:
            del lines[at]
        elif kind == 3:
            lines.insert(at, lines[int(rng.integers(len(lines)))])
        elif kind == 4:
            lines = lines[: at + 1]
            lines[at] = lines[at][: rng.integers(len(lines[at]) + 1)]
        else:
            lines[at] = lines[at] + " " + str(rng.choice(ODD_NUMBERS))
        if not lines:
            return ["HIERARCHY"]
    return lines


def read(path, text):
    """Whether a file can be read; any other exception than the reader's fails the test."""
    path.write_text(text, encoding="utf-8", newline="")
    try:
        motion = load_motion(path)
    except NumpyCaeError as error:
        assert path.name in str(error)
        assert len(str(error)) < 2000
        return False
    assert len(motion) and np.isfinite(motion.skeleton.offsets).all()
    lost = np.isnan(motion.rotations).any() or np.isnan(motion.translations).any()
    assert not lost or "not numbers" in motion.note
    return True


def attack(seed, number, folder):
    """How many of so many files could be read."""
    rng = np.random.default_rng(seed)
    count = 0
    for _ in range(number):
        lines = grammatical_file(rng)
        if rng.random() < 0.7:
            lines = edited(lines, rng)
        count += read(folder / "attacked.bvh", str(rng.choice(LINE_ENDS)).join(lines))
    return count


def test_a_file_of_the_grammar_is_read(tmp_path):
    rng = np.random.default_rng(0)
    assert read(tmp_path / "attacked.bvh", "\n".join(grammatical_file(rng)))


def test_a_few_attacked_files_are_read_or_refused(tmp_path):
    count = attack(0, 20, tmp_path)
    assert 0 < count < 20


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(400))
def test_attacked_files_are_read_or_refused(seed, tmp_path):
    assert 0 < attack(1000 + seed, BATCH, tmp_path) < BATCH
