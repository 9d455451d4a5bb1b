"""The student's copy of a lesson, without solutions, as nbgrader's generate_assignment makes it."""

from copy import deepcopy

from numpy_cae.verify.submission import is_exercise

BEGIN, END = "### BEGIN SOLUTION", "### END SOLUTION"
STUB = ("# YOUR CODE HERE", "raise NotImplementedError()")


def student_copy(notebook: dict) -> dict:
    """A copy of the notebook with a stub in place of every solution, and without outputs.

    Raises
    ------
    ValueError
        If a solution region is not closed, or is in a cell that is no exercise.
    """
    copy = deepcopy(notebook)
    copy["metadata"].pop("numpy_cae", None)
    for cell in copy["cells"]:
        if cell["cell_type"] != "code":
            continue
        cell["outputs"], cell["execution_count"] = [], None
        cell["source"] = _without_solutions(cell)
        if cell["metadata"].get("nbgrader", {}).get("locked"):
            cell["metadata"] |= {"editable": False, "deletable": False}
    return copy


def _without_solutions(cell: dict) -> str:
    kept: list[str] = []
    inside = False
    for line in cell["source"].splitlines():
        marker = line.strip()
        if marker in (BEGIN, END):
            if inside == (marker == BEGIN):
                raise ValueError(f"cell {cell['id']}: {marker} is in the wrong place")
            if not is_exercise(cell):
                raise ValueError(f"cell {cell['id']}: a solution in a cell that is no exercise")
            inside = not inside
            if inside:
                indent = line[: len(line) - len(line.lstrip())]
                kept += [indent + stub for stub in STUB]
        elif not inside:
            kept.append(line)
    if inside:
        raise ValueError(f"cell {cell['id']}: {BEGIN} without {END}")
    return "\n".join(kept)
