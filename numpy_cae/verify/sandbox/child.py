"""The grader's process: test each function of a submission in a forked process of its own."""

from __future__ import annotations

import json
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from numpy_cae.verify.catalogue import CATALOGUE as OPERATIONS
from numpy_cae.verify.catalogue import load_catalogue
from numpy_cae.verify.reporting import holds, report_on
from numpy_cae.verify.sandbox import confinement
from numpy_cae.verify.sandbox.apart import do_apart
from numpy_cae.verify.submission import LONGEST_TEXT, described, read_submission

MAX_NOTES = 5


def main() -> None:
    """Do the request on standard input; one reply goes to standard output."""
    confinement.adopt_orphans()
    holds(OPERATIONS["unpool_even"], lambda y: y)  # imports what a report needs
    print(json.dumps(reply_to(json.load(sys.stdin))))


def reply_to(request: dict) -> dict:
    """The reply to a request: what the file lacks, and the results of the functions that it has.

    The request has the file, the catalogue, the functions by task, the tasks whose solutions are
    given, and the limits.
    """
    submission, catalogue = read_submission(Path(request["path"])), load_catalogue(request["from"])
    given = {name: catalogue[name].solution for name in request["given"]}
    wanted, deadline = request["wanted"], time.monotonic() + request["seconds"]

    def apart(work: Callable[[], dict], left: int) -> dict:
        """The result of work in a confined process; the time that is left is for so many."""
        seconds = min(2 * request["cpu_seconds"], (deadline - time.monotonic()) / left)
        if seconds <= 0:
            return {"failed": "the time limit for the whole file is used up"}
        return do_apart(lambda: _confined(work, request), seconds)

    def names() -> dict:
        functions, problems = submission.run(given)
        return {"found": [n for n in wanted.values() if n in functions], "problems": problems}

    def report(task: str, function: str) -> dict:
        functions, _ = submission.run(given)
        made = report_on(catalogue[task], functions[function], function, request["any_convention"])
        return {"report": made.as_reply()}

    loaded = apart(names, 1)
    there = [task for task, name in wanted.items() if name in loaded.get("found", ())]
    results = {
        task: apart(partial(report, task, wanted[task]), len(there) - done)
        for done, task in enumerate(there)
    }
    return {"failed": "", "problems": [], **loaded, "results": results}


def _confined(work: Callable[[], dict], request: dict) -> dict:
    """Do work with limits; a warning becomes a note, an exception the reason of a failure."""
    kept = confinement.confine(request["cpu_seconds"], request["megabytes"], Path.cwd())
    with _noted_warnings() as notes:
        try:
            result = work()
        except BaseException as error:  # such as KeyboardInterrupt
            result = {"failed": described(error)}
    del kept
    return {**result, "notes": list(notes)}


@contextmanager
def _noted_warnings() -> Iterator[dict[str, None]]:
    notes: dict[str, None] = {}

    def note(message, category, filename, lineno, *others) -> None:
        if len(notes) < MAX_NOTES:
            notes[f"{category.__name__}: {message} (line {lineno})"[:LONGEST_TEXT]] = None

    with warnings.catch_warnings():
        warnings.simplefilter("default")
        warnings.showwarning = note
        yield notes
