"""The grader's process: read a submission, and test each of its functions in a forked process."""

from __future__ import annotations

import json
import os
import sys
import time
import traceback
import warnings
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np

from numpy_cae.verify.catalogue import CATALOGUE as OPERATIONS
from numpy_cae.verify.reporting import holds, report_on
from numpy_cae.verify.sandbox import confinement
from numpy_cae.verify.sandbox.apart import Ended, do_apart
from numpy_cae.verify.submission import Submission, SubmissionError, read_submission

MAX_NOTES = 5
LONGEST_TEXT = 1000
MISSING = (
    f"no function has an operation's name ({', '.join(OPERATIONS)}); "
    "name one with --as conv1d=my_conv"
)


def main() -> None:
    """Do the request on standard input; one reply goes to standard output.

    The request names the file, the catalogue, the lesson, functions with other names, and the
    limits. The reply has the result of each task, and what is wrong with the file as a whole.
    """
    request = json.load(sys.stdin)
    confinement.adopt_orphans()
    module = import_module(request["catalogue"])
    holds(OPERATIONS["unpool_even"], lambda y: y)  # imports what a report needs
    print(json.dumps(Grading(request, module).reply()))


class Grading:
    """One submission, and the tasks that its functions are tested for."""

    def __init__(self, request: dict, module: ModuleType) -> None:
        self.catalogue, self.named = module.CATALOGUE, request["named"]
        self.any_convention = request["any_convention"]
        self.cpu_seconds, self.megabytes = request["exercise_seconds"], request["megabytes"]
        self.deadline = time.monotonic() + request["seconds"]
        self.submission, self.fault = Submission(Path(request["path"])), ""
        try:
            self.submission = read_submission(self.submission.path)
        except (SubmissionError, OSError) as error:
            self.fault = str(error)
        is_notebook, lessons = self.submission.is_notebook, getattr(module, "ASSIGNMENTS", {})
        self.assigned = lessons.get(request["lesson"] or self.submission.lesson(lessons), ())
        known = self.assigned or (self.catalogue if is_notebook else OPERATIONS)
        self.wanted = {name: name for name in known} | self.named
        own = self.assigned or self.submission.defined() & self.wanted.keys()
        given = {name for task in own for name in self.catalogue[task].given} - set(self.assigned)
        self.given = {name: self.catalogue[name].solution for name in given}

    def reply(self) -> dict:
        """The result of each task, and what is wrong with the file as a whole."""
        loaded = {"failed": self.fault} if self.fault else self._apart(self._names, 1)
        problems = loaded.get("problems", [])
        fault = loaded.get("failed", "")
        if problems and not self.submission.is_notebook:
            fault = f"at import: {problems[0]}"
        found = self.submission.defined() if fault else loaded["found"]
        tasks = {
            task: function
            for task, function in self.wanted.items()
            if function in found or task in self.assigned or task in self.named
        }
        results = []
        for done, (task, function) in enumerate(tasks.items()):
            if fault or function not in found:
                result = {"failed": fault or f"it has no function {function}"}
            else:
                result = self._apart(partial(self._report, task, function), len(tasks) - done)
            results.append({"task": task, "function": function, **result})
        faults = [fault] if fault else problems + ([] if tasks else [MISSING])
        return {"faults": faults, "results": results}

    def _names(self) -> dict:
        functions, problems = load(self.submission, self.given)
        return {"found": [n for n in self.wanted.values() if n in functions], "problems": problems}

    def _report(self, task: str, function: str) -> dict:
        functions, _ = load(self.submission, self.given)
        report = report_on(self.catalogue[task], functions[function], function, self.any_convention)
        return {"report": report.as_reply()}

    def _apart(self, work: Callable[[], dict], left: int) -> dict:
        """The result of work in a confined process; the time that is left is for so many."""
        seconds = min(2 * self.cpu_seconds, (self.deadline - time.monotonic()) / left)
        if seconds <= 0:
            return {"failed": "the time limit for the whole file is used up"}
        try:
            return do_apart(lambda: self._confined(work), seconds)
        except Ended as end:
            return {"failed": str(end)}

    def _confined(self, work: Callable[[], dict]) -> dict:
        """Do work with limits; a warning becomes a note, an exception the reason of a failure."""
        notes: dict[str, None] = {}

        def note(message, category, filename, lineno, *others) -> None:
            if len(notes) < MAX_NOTES:
                notes[f"{category.__name__}: {message} (line {lineno})"[:LONGEST_TEXT]] = None

        kept = confinement.confine(self.cpu_seconds, self.megabytes, os.getcwd())
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("default")
                warnings.showwarning = note
                result = work()
        except BaseException as error:  # such as KeyboardInterrupt
            result = {"failed": _described(error)}
        del kept
        return {**result, "notes": list(notes)}


def load(
    submission: Submission, given: dict[str, Callable]
) -> tuple[dict[str, Callable], list[str]]:
    """Run a submission as a module; return the functions it defines, and why cells failed."""
    module, is_notebook = ModuleType("student"), submission.is_notebook
    sys.modules["student"], sys.modules["mine"] = module, ModuleType("mine")
    vars(sys.modules["mine"]).update(given)  # an earlier lesson's are the package's own
    sys.path.append(str(submission.path.parent))
    own = vars(module)
    own |= {"__file__": str(submission.path), "__builtins__": vars(sys.modules["builtins"])}
    own |= {**given, **({"np": sys.modules["numpy"]} if is_notebook else {})}
    problems = []
    for name, source in submission.cells:
        try:
            with np.errstate():
                exec(compile(source, name, "exec"), own)
        except BaseException as error:  # such as SystemExit
            cell = f"{name}: " if is_notebook else ""
            problems.append(cell + _described(error, name))
    there = list(own.items())
    return {name: f for name, f in there if callable(f) and f is not given.get(name)}, problems


def _described(error: BaseException, file: str = "") -> str:
    """An exception's type, message and line in a file, whatever its class does."""
    try:
        text = f"{type(error).__name__}: {error}"[:LONGEST_TEXT]
    except Exception:
        text = f"{type(error).__name__}, whose message cannot be printed"
    if isinstance(error, SystemExit):
        text = "it calls sys.exit"
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    return f"{text} (line {lines[-1]})" if lines else text
