"""A mark does not depend on luck: the same files get the same marks beside busy processes.

    ROUNDS=25 pytest -m thorough tests/verify/test_repeated_gradings.py

grades twenty files 25 times by the command, beside four processes that compute without end.
"""

import json
import os
import subprocess
import sys
from collections import Counter

import pytest
from test_hostile_files import CHEAT, FILLS, IMPORTS, REPLACES_MODULES, REPLACES_TESTS, WAITS

ROUNDS = int(os.environ.get("ROUNDS", "2"))
BUSY = 4
TANH = "def tanh(x):\n    y = np.tanh(x)\n    return y, lambda dy: dy * (1 - {0} * {0})\n"
RIGHT, WRONG = IMPORTS + TANH.format("y"), IMPORTS + TANH.format("x")
LINEAR = "def linear(x, w, b):\n    return {}, None\n"
SPINS = "while time.process_time() < 1.5: pass\n"
GRU = "def gru_step(x, h, w, u, b, c):\n    return h, lambda dy: (x, dy, w, u, b, c)\n"
FILES = {
    "right": RIGHT,
    "right_and_slow": RIGHT + SPINS,
    "right_and_waits": RIGHT + WAITS,
    "right_and_replaces": RIGHT + REPLACES_MODULES,
    "right_with_thread": RIGHT + "threading.Thread(target=time.sleep, args=(100,)).start()",
    "right_and_prints": RIGHT + "print('x' * 10**6)",
    "right_and_missing": RIGHT + LINEAR.format("x @ w + b"),
    "wrong": WRONG,
    "wrong_and_replaces": WRONG + REPLACES_TESTS,
    "wrong_and_cheats": WRONG + CHEAT,
    "wrong_gru": IMPORTS + GRU,
    "raises": RIGHT + "1 / 0",
    "recursion": "f = lambda: f()\nf()\n" + RIGHT,
    "recursion_in_call": IMPORTS + "def tanh(x):\n    return tanh(x)\n",
    "crashes": RIGHT + "ctypes.string_at(0)",
    "exits": IMPORTS + "def tanh(x):\n    os._exit(0)\n",
    "memory": RIGHT + "x = np.ones(10**12)",
    "fills": RIGHT + FILLS,
    "loops": IMPORTS + "def tanh(x):\n    while True: pass\n",
    "sleeps": IMPORTS + "def tanh(x):\n    time.sleep(1000)\n",
}


def marks(folder) -> dict:
    """The points, faults and first problem of each function, of each file, by the command."""
    command = [sys.executable, "-m", "numpy_cae", "verify", str(folder), "--json"]
    printed = subprocess.run([*command, "--time-limit", "6"], capture_output=True, check=False)
    return {
        file["file"].rpartition("/")[2]: json.dumps(
            [file["points"], file["possible"], file["faults"]]
            + [
                [one["held"], one["problem"][:20]]
                for o in file["operations"]
                for one in o["properties"]
            ]
        )
        for file in json.loads(printed.stdout)
    }


@pytest.mark.thorough
def test_marks_do_not_depend_on_luck(tmp_path, counted):
    for name, content in FILES.items():
        (tmp_path / f"{name}.py").write_text(content)
    different = Counter()
    expected = marks(tmp_path)
    assert len(expected) == len(FILES) == 20
    points, possible, *_ = json.loads(expected["right_and_slow.py"])
    assert points == possible > 0
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(BUSY)]
    try:
        for number in range(ROUNDS):
            found = marks(tmp_path)
            different.update(name for name in expected if found.get(name) != expected[name])
            counted(f"{(number + 1) * 20} gradings beside {BUSY} busy processes: {different}")
    finally:
        for process in busy:
            process.kill()
            process.wait()
    assert not different
