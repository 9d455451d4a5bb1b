"""What the cells of a notebook call: reports on a student's functions, and progress."""

from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import replace

from numpy_cae.course.catalogue import CATALOGUE, EXERCISES, LESSONS
from numpy_cae.course.cell_alone import Graded, as_graded
from numpy_cae.course.exercises.exercise import MAKES, with_hint
from numpy_cae.course.feedback import Feedback, Printed
from numpy_cae.course.mine_file import FILE, NotSavedError, nbgrader_runs, read_mine, run_mine, save
from numpy_cae.course.stand_in import attempt_of, is_stand_in, stand_in, unsolved
from numpy_cae.verify.grading.report import Report, holds, try_all
from numpy_cae.verify.operations import operation_catalogue


def report(name: str, function: Callable, hint: int = 0) -> Feedback | int:
    """Test a student's function for every property of an operation or an exercise.

    While nbgrader runs the notebook, the report is printed and its points are returned, because
    nbgrader takes a number that a check cell returns as the points of the exercise. The points are
    those of `numpy-cae verify`.

    In a notebook the report is shown where it is the last line of a cell; in a script nothing is
    shown: `print(course.report(name, function))`.

    The report tests what the grader has: the function as its cell alone defines it. What the cell
    lacks, such as a helper in another cell, is printed.

    The first lines that the function prints in the tests are shown above the report. Where
    `solved` replaced the function by the package's own, the one that it replaced is tested.

    After a first attempt, `hint=1` adds a hint to the report and `hint=2` a second one. Raises a
    ValueError if there is no such operation or exercise, or no such hint.
    """
    exercise = operation_catalogue.find_exercise(name, CATALOGUE)
    called = getattr(function, "__name__", name)
    if is_stand_in(function):
        called = name
        function = attempt_of(function)
        if function is unsolved:
            print(f"{name} is the package's own now: run the cell with your function again first")
    graded = _print_problems(name, function)
    function = graded.function
    if not graded.has_points:
        exercise = _without_points(exercise)
    if nbgrader_runs():
        with redirect_stdout(Printed()), redirect_stderr(Printed()):  # it would give 0 points
            result = Report(exercise, called, try_all(exercise, function))
        print(result)
        return result.points
    exercise = with_hint(exercise, hint)
    with redirect_stdout(Printed()) as printed:
        feedback = Feedback(exercise, called, try_all(exercise, function))
    print(printed, end="")
    if feedback.unsolved:
        later = "a hint is shown after your first attempt" if hint else ""
        feedback = replace(feedback, exercise=replace(exercise, hint=later))
    return feedback


def solved(name: str, function: Callable) -> Callable:
    """The function for later cells: the student's if every property holds, else the package's own.

    If the folder of the notebook has a file mine.py, the student's function is saved to it for
    later lessons. Prints what is done; raises a ValueError if there is no such exercise.
    """
    if name not in EXERCISES:
        raise ValueError(f"no exercise is called {name!r}; there are {', '.join(EXERCISES)}")
    is_right = False
    if not is_stand_in(function):
        graded = _print_problems(name, function)
        with redirect_stdout(Printed()):
            is_right = graded.has_points and holds(EXERCISES[name], graded.function)
    if not is_right:
        again = "run this cell again when yours is right"
        print(f"{name}: the next cells use the package's own; {again}")
        return function if is_stand_in(function) else stand_in(name, function)
    try:
        with redirect_stdout(Printed()):  # the cell is run again
            where = f" and later lessons ({FILE})" if save(name, function) else ""
        print(f"{name}: the next cells{where} use your function")
    except NotSavedError as error:
        print(f"{name}: the next cells use your function. It is not saved to {FILE}: {error}")
    return function


def _print_problems(name: str, function: Callable) -> Graded:
    """The function as the grader has it; what is wrong with its cell is printed."""
    graded = as_graded(name, function)
    for problem in graded.problems:
        print(problem)
    return graded


def _without_points(exercise: operation_catalogue.Exercise) -> operation_catalogue.Exercise:
    """The exercise, for a function that cannot earn its points."""
    properties = tuple(replace(property_, points=0) for property_ in exercise.properties)
    return replace(exercise, properties=properties)


def example(name: str, seed: int, **sizes: int) -> dict[str, object]:
    """The arguments of a counterexample by name, for the call that a report prints.

    Raises a ValueError if there is no such operation or exercise, or a size is missing.
    """
    exercise = operation_catalogue.find_exercise(name, CATALOGUE)
    return operation_catalogue.example(exercise, seed, **sizes).arguments


def progress() -> None:
    """Print how many functions mine.py has, what the finished lessons make, and what is next."""
    solved_names: set[str] = set()
    with suppress(FileNotFoundError, NotSavedError, UnicodeDecodeError):
        solved_names = set(run_mine(read_mine())) & set(EXERCISES)
    finished = []
    unfinished = []
    for number, exercises in LESSONS.items():
        if solved_names.issuperset(exercise.name for exercise in exercises):
            finished.append(number)
        else:
            unfinished.append(number)
    print(f"{len(solved_names)} of {len(EXERCISES)} functions are yours")
    if finished:
        print(f"They add up to: {', '.join(MAKES[number] for number in finished)}.")
    if unfinished:
        print(f"Next: {MAKES[unfinished[0]]} (lesson {unfinished[0]}).")
