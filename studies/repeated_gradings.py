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
from studies.marks.pieces import PIECES
from studies.shared.result import Result, Table

BUSY = 4
"""BUSY: this many processes compute beside the gradings."""
FILES = (
    "RIGHT", "RIGHT SPINS", "RIGHT WAITS", "RIGHT REPLACES_MODULES", "RIGHT THREAD", "RIGHT PRINTS",
    "RIGHT MISSING", "WRONG", "WRONG REPLACES_TESTS", "WRONG CHEAT", "GRU", "RIGHT RAISES",
    "RECURSION RIGHT", "CALLS_ITSELF", "RIGHT CRASHES", "EXITS", "RIGHT MEMORY", "RIGHT FILLS",
    "LOOPS", "SLEEPS",
)  # fmt: skip
"""The pieces of each file, after the imports."""


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
        for name in FILES:
            pieces = (PIECES[piece] for piece in ["IMPORTS", *name.split()])
            Path(folder, f"{name.replace(' ', '_')}.py").write_text("\n".join(pieces))
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
    rows = [[name, different[name]] for name in expected]
    caption = f"Gradings that differ, of {rounds} for each file:"
    return Result("Repeated gradings", [Table(caption, ["file", "gradings that differ"], rows)])
