"""The grader's process: test each function of a submission in a forked process of its own."""

import json
import sys
import time
import warnings
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path

from numpy_cae.verify.grading.report import holds, report_on
from numpy_cae.verify.grading.sandbox.apart import do_apart
from numpy_cae.verify.grading.sandbox.confinement import adopt_orphans, confine
from numpy_cae.verify.grading.submission import read_submission
from numpy_cae.verify.operations.catalogue import CATALOGUE as OPERATIONS
from numpy_cae.verify.operations.trial import described

MAX_NOTES = 5


def main() -> None:
    """Do the request on standard input; one reply goes to standard output."""
    adopt_orphans()
    holds(OPERATIONS["unpool_even"], lambda y: y)  # imports what a report needs
    print(json.dumps(reply_to(json.load(sys.stdin))))


def reply_to(request: dict) -> dict:
    """What the file lacks, and for each task whose function it has a report, or why it failed."""
    submission = read_submission(Path(request["path"]))
    catalogue = import_module(request["from"]).CATALOGUE
    given = {name: catalogue[name].solution for name in request["given"]}
    wanted, deadline = request["wanted"], time.monotonic() + request["seconds"]

    def apart(work: Callable[[], dict], left: int) -> dict:
        """The result of work in a confined process; the time that is left is for so many."""
        seconds = min(2 * request["cpu_seconds"], (deadline - time.monotonic()) / left)
        if seconds <= 0:
            return {"failed": "the time limit for the whole file is used up"}
        return do_apart(partial(_confined, work, request), seconds)

    def names() -> dict:
        functions, problems = submission.run(given, {})
        return {"found": [n for n in wanted.values() if n in functions], "problems": problems}

    def report(task: str, function: str) -> dict:
        functions, _ = submission.run(given, instead)
        made = report_on(catalogue[task], functions[function], function, request["any_convention"])
        return {"report": made.as_json()}

    loaded = apart(names, 1)
    there = [task for task, name in wanted.items() if name in loaded.get("found", ())]
    results, instead = {}, {}
    for task, function in wanted.items():
        if task in there:
            results[task] = apart(partial(report, task, function), len(there) - len(results))
        if task in request["replaced"] and not results.get(task, {}).get("report", {}).get("held"):
            instead[function] = catalogue[task].solution
    return {"failed": "", "problems": [], **loaded, "results": results}


def _confined(work: Callable[[], dict], request: dict) -> dict:
    """Do work with limits; a warning becomes a note, an exception the reason of a failure."""
    kept = confine(request["cpu_seconds"], request["megabytes"], Path.cwd())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        try:
            result = work()
        except BaseException as error:  # such as KeyboardInterrupt
            result = {"failed": described(error)}
    del kept
    notes = (f"{described(one.message)} (line {one.lineno})" for one in caught[:MAX_NOTES])
    return {**result, "notes": list(dict.fromkeys(notes))}


if __name__ == "__main__":
    main()
