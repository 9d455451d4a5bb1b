"""Imports that are refused: this package, and libraries that differentiate."""

from __future__ import annotations

import ast
from collections.abc import Iterator

AUTODIFF = (
    "aesara autograd casadi chainer cupy dynet flax jax keras mindspore mlx mxnet paddle pytensor "
    "sympy tangent tensorflow theano tinygrad torch"
).split()
REFUSED = ("numpy_cae", *AUTODIFF)
BY_NAME = ("__import__", "import_module", "run_module")


def is_refused(module: str) -> bool:
    """Whether a module belongs to a refused package."""
    return module.partition(".")[0] in REFUSED


def refused_imports(source: str) -> list[str]:
    """Each refused import in a file, as "line 3: torch"; the block under __main__ may have any.

    Raises
    ------
    SyntaxError, ValueError
        If the file is not Python.
    """
    return [
        f"line {line}: {module}"
        for line, module in _imports(ast.parse(source))
        if is_refused(module)
    ]


def _imports(node: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and module of every import in a piece of a program, but not under __main__."""
    if isinstance(node, ast.If) and "__main__" in ast.dump(node.test):
        for other in node.orelse:
            yield from _imports(other)
        return
    if isinstance(node, ast.Import):
        yield from ((node.lineno, alias.name) for alias in node.names)
    elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
        yield node.lineno, node.module
    elif isinstance(node, ast.Call) and _called(node.func) in BY_NAME:
        for argument in node.args:
            if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
                yield node.lineno, argument.value
    for child in ast.iter_child_nodes(node):
        yield from _imports(child)


def _called(function: ast.expr) -> str | None:
    return getattr(function, "id", None) or getattr(function, "attr", None)
