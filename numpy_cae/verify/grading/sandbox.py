"""The grader's process: test each function of a submission, which runs in another process.

This process draws cases, sends arguments, gets arrays back and compares them (`channel`). The file
is run in a confined process, one for each function (`student_process`), so that nothing that it
changes reaches the comparisons.
"""

import json
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from numpy_cae.confined.channel import MessageError
from numpy_cae.confined.confinement import PR_SET_PDEATHSIG, set_process_option
from numpy_cae.confined.template import Template
from numpy_cae.verify.checks.messages import error_text
from numpy_cae.verify.grading.report import reply_of, try_all
from numpy_cae.verify.grading.student_process import (
    NO_RESULT,
    ProcessEnded,
    StudentProcess,
    Ungraded,
)
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.operation_catalogue import Exercise
from numpy_cae.verify.operations.property import Outcome

HEARTBEAT_SECONDS = 1.0
"""So often this process says that it runs."""


def main(template: Template | None) -> None:
    """Do the request on standard input; the last line on standard output is the reply.

    The lines before it are empty: each says that this process was not stopped.
    `python -m numpy_cae.confined` calls this function with the template of confined processes.
    """
    set_process_option(PR_SET_PDEATHSIG, signal.SIGKILL)
    threading.Thread(target=_send_heartbeats, daemon=True).start()
    reply = reply_to(json.load(sys.stdin), template)
    print(json.dumps(reply), flush=True)


def _send_heartbeats() -> None:
    """Write an empty line from time to time."""
    while True:
        time.sleep(HEARTBEAT_SECONDS)
        os.write(1, b"\n")


def reply_to(request: dict[str, Any], template: Template | None = None) -> dict[str, Any]:
    """What the file lacks, and for each function its outcomes or the reason why there are none.

    The template starts the confined processes; without one, they are programs. If the grader itself
    fails, the reply says why as `ungraded`.
    """
    try:
        return _grade(request, template)
    except Ungraded as error:
        return {"failed": "", "ungraded": str(error)}
    except Exception as error:  # a fault of ours, a full disk, no memory
        return {"failed": "", "ungraded": f"its grader failed: {error_text(error, __file__)}"}


def _grade(request: dict[str, Any], template: Template | None) -> dict[str, Any]:
    """The reply if the grader itself does not fail."""
    catalogue: Mapping[str, Exercise] = import_module(request["catalogue"]).CATALOGUE
    reply: dict[str, Any] = {"defined": (), "problems": [], "failed": ""}
    results: dict[str, dict[str, Any]] = {}
    replaced: list[str] = []  # solutions take the place of functions that do not hold
    rest = list(request["requested"])
    first = _started(request, catalogue, replaced, rest, template)
    with first as process:  # it also tests the first function
        try:
            functions, problems = _run(process, request, replaced)
        except ProcessEnded as ended:
            return reply | {"failed": str(ended)}
        reply["problems"] = problems
        reply["defined"] = [name for name in rest if name in functions]
        name = rest[0]
        if name in functions:
            results[name] = _try_function(process, catalogue[name], functions[name])
    for name in rest:
        if name in reply["defined"] and name not in results:
            with _started(request, catalogue, replaced, [name], template) as process:
                results[name] = _run_and_try(process, request, replaced, catalogue[name])
        if name in request["replaced"] and not _is_right(results.get(name)):
            replaced.append(name)
    return {**reply, "results": results}


@contextmanager
def _started(
    request: Mapping[str, Any],
    catalogue: Mapping[str, Exercise],
    replaced: Sequence[str],
    names: Sequence[str],
    template: Template | None,
) -> Iterator[StudentProcess]:
    """A confined process for some functions; it and all that it has started are ended afterwards.

    It gets the solutions that are provided or replaced, and keeps no other of these functions.
    """
    available = [*request["provided"], *replaced]
    solutions = {name: catalogue[name].solution for name in available}
    tested = [catalogue[name].solution for name in names if name not in available]
    beside = Path(request["path"]).parent
    limits = request["seconds"], request["megabytes"]
    process = StudentProcess(*limits, beside, solutions, tested, template)
    try:
        yield process
    finally:
        process.end()


def _run(
    process: StudentProcess, request: Mapping[str, Any], replaced: Sequence[str]
) -> tuple[dict[str, Callable], list[str]]:
    """Run the file; returns the functions that it defines, and what went wrong."""
    file = request["path"]
    is_notebook = request["is_notebook"]
    cells = request["cells"]
    if not is_notebook:
        cells = [(file, source.encode("latin-1")) for _, source in cells]
    try:
        functions, raised = process.run_file(
            file, cells, is_notebook, request["provided"], replaced
        )
    except (MessageError, ValueError, TypeError, AttributeError):
        raise ProcessEnded(NO_RESULT) from None
    problems = []
    for name, raise_again in raised:
        part = name if is_notebook else "at import"
        try:
            raise_again()
        except MessageError:
            raise ProcessEnded(NO_RESULT) from None
        except (Exception, SystemExit) as error:
            problems.append(f"{part}: {error_text(error, name)}")
    return functions, problems


def _run_and_try(
    process: StudentProcess,
    request: Mapping[str, Any],
    replaced: Sequence[str],
    exercise: Exercise,
) -> dict[str, Any]:
    """The outcomes of the properties of one of the file's functions."""
    try:
        functions, _ = _run(process, request, replaced)
    except ProcessEnded as ended:
        return {"failed": str(ended)}
    function = functions.get(exercise.name)
    if function is None:
        return {"failed": f"run again, it has no function {exercise.name}"}
    return _try_function(process, exercise, function)


def _try_function(
    process: StudentProcess, exercise: Exercise, function: Callable
) -> dict[str, Any]:
    """The outcomes of all properties, or of those before the process ended and why it did."""
    last: dict[str, Any] = {}

    def note_case(outcomes: Sequence[Outcome], case: Case) -> None:
        process.require_alive()
        last.update(reply_of(outcomes), trying=str(case))

    try:
        return {**reply_of(try_all(exercise, function, note_case)), "failed": ""}
    except ProcessEnded as ended:
        return {**last, "failed": str(ended)}
    except MessageError:
        return {**last, "failed": NO_RESULT}


def _is_right(result: Mapping[str, Any] | None) -> bool:
    """Whether a function is there, its process has ended well and every property holds."""
    if result is None:
        return False
    return not result["failed"] and all(outcome["held"] for outcome in result["outcomes"])
