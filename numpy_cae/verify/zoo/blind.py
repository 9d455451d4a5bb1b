"""A bug of the zoo with its name and its sentence taken off: to be found by reading."""

from __future__ import annotations

import ast
import inspect
import textwrap

from numpy_cae.verify.zoo.bug import Bug


def blind_source(bug: Bug, called: str = "suspect") -> str:
    """The source of a bug's implementation, under another name and without its docstring.

    Parameters
    ----------
    bug : Bug
    called : str
        The name to show it under.

    Returns
    -------
    str
    """
    source = textwrap.dedent(inspect.getsource(bug.implementation))
    (function,) = ast.parse(source).body
    docstring, first = function.body[0], function.body[1]
    lines = source.splitlines()
    head = lines[function.lineno - 1 : docstring.lineno - 1]
    body = lines[first.lineno - 1 :]
    return "\n".join([*head, *body]).replace(f"def {bug.name}(", f"def {called}(", 1)
