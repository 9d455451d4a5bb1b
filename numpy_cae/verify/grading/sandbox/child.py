"""The grader's process: test each function of a submission in a forked process of its own."""

import json
import sys
import time
import warnings
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path

import numpy.ma  # noqa: F401  np.median imports it: too late where a file changes modules

from numpy_cae.verify.grading.report import report
from numpy_cae.verify.grading.sandbox.apart import do_apart
from numpy_cae.verify.grading.sandbox.confinement import adopt_orphans, confine
from numpy_cae.verify.grading.submission import read_submission
from numpy_cae.verify.operations.trial import described

MAX_NOTES = 5


def main() -> None:
    """Do the request on standard input; one reply goes to standard output."""
    adopt_orphans()
    print(json.dumps(reply_to(json.load(sys.stdin))))


def reply_to(request: dict) -> dict:
    """What the file lacks, and for each function a report or the reason why there is none."""
    submission = read_submission(Path(request["path"]))
    catalogue = import_module(request["catalogue"]).CATALOGUE
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

    def tested(name: str, function: str) -> dict:
        functions, _ = submission.run(given, instead)
        made = report(catalogue[name], functions[function], request["any_convention"], function)
        return made.as_reply()

    loaded = apart(names, 1)
    there = [name for name, function in wanted.items() if function in loaded.get("found", ())]
    results, instead = {}, {}
    for name, function in wanted.items():
        outcomes: list = []
        if name in there:
            results[name] = apart(partial(tested, name, function), len(there) - len(results))
            outcomes = results[name].get("outcomes", [])
        if name in request["replaced"] and not (outcomes and all(held for held, *_ in outcomes)):
            instead[function] = catalogue[name].solution
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
