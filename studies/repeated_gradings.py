"""A mark does not depend on luck: the same files get the same marks beside busy processes.

    python -m studies repeated_gradings --rounds 25

grades twenty files 25 times by the command, beside four processes that compute without end, and
counts how often the marks of each file were others than those of a first grading without these.
"""

import json
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from numpy_cae.cli.shared.output import note
from studies.marks.hostile import (
    CHEAT,
    FILLS,
    IMPORTS,
    REPLACES_MODULES,
    REPLACES_TESTS,
    WAITS,
)
from studies.shared.result import Result, Table

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


def run(rounds: int = 25) -> Result:
    """Grade the files again and again, and count what differs."""
    different: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for name, content in FILES.items():
            Path(folder, f"{name}.py").write_text(content)
        expected = marks(folder)
        busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(BUSY)]
        try:
            for number in range(1, rounds + 1):
                found = marks(folder)
                different.update(name for name in expected if found.get(name) != expected[name])
                note(f"{number * len(FILES)} gradings, different: {dict(different)}")
        finally:
            for process in busy:
                process.kill()
                process.wait()
    rows = [[name, different[name]] for name in FILES]
    caption = f"Gradings that differ, of {rounds} for each file:"
    return Result("Repeated gradings", [Table(caption, ["file", "gradings that differ"], rows)])
