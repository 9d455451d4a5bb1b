"""`check_gradients` compared with the checks of PyTorch, JAX and autograd, as far as installed.

Functions with pullbacks written in NumPy, right and wrong, are wrapped for each library and checked
with its default settings (in reverse mode, which alone uses the pullback). Then the layers of small
projects in NumPy are tried as they are, and both versions, the wrong and the fixed one, of the
wrong gradients that libraries really had, also with the properties of `verify.properties_of` and
with differences of the sum of the outputs.
docs/lab_book/gradient_checks.md and docs/wrong_gradients.md have the figures, docs/tables the
lists:

    python -m studies gradient_checks
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from copy import deepcopy

import numpy as np

from numpy_cae import verify
from numpy_cae.verify import check_gradients
from numpy_cae.verify.checks.leaves import leaves, rebuild
from studies.gradients.cases import RIGHT, WRONG
from studies.gradients.published import PublishedOperation, historical_bugs, layers
from studies.shared.result import Result, Table


def passes_check_gradients(f: Callable, inputs: tuple) -> bool:
    try:
        check_gradients(f, *inputs)
    except (AssertionError, TypeError):  # a TypeError says that it cannot be checked
        return False
    return True


def passes_gradcheck(f: Callable, inputs: tuple) -> bool:
    import torch

    class Wrapped(torch.autograd.Function):
        @staticmethod
        def forward(context, *tensors):
            value, context.pullback = f(*(t.detach().numpy() for t in tensors))
            parts = value if isinstance(value, tuple) else (value,)
            tensors = tuple(torch.from_numpy(np.array(part)) for part in parts)
            return tensors if isinstance(value, tuple) else tensors[0]

        @staticmethod
        def backward(context, *dys):
            upstream = [dy.detach().numpy() for dy in dys]
            pulled = context.pullback(tuple(upstream) if len(upstream) > 1 else upstream[0])
            pulled = pulled if isinstance(pulled, tuple) else (pulled,)
            gradients = [torch.from_numpy(np.array(gradient)) for gradient in pulled]
            return (*gradients, *[None] * (len(inputs) - len(gradients)))

    tensors = [torch.from_numpy(np.array(x)) for x in inputs]
    for tensor in tensors:
        if tensor.is_floating_point():
            tensor.requires_grad_()
    return torch.autograd.gradcheck(Wrapped.apply, tensors, raise_exception=False)


def passes_jax(f: Callable, inputs: tuple) -> bool:
    import jax
    from jax.test_util import check_grads

    jax.config.update("jax_enable_x64", True)
    value = f(*inputs)[0]
    shapes = jax.tree.map(lambda y: jax.ShapeDtypeStruct(np.shape(y), np.asarray(y).dtype), value)
    floats = [x for x in inputs if np.issubdtype(x.dtype, np.floating)]
    constants = inputs[len(floats) :]

    def value_of(*arrays):
        return f(*map(np.array, arrays), *constants)[0]

    def pulled(dy, *arrays):
        gradients = f(*map(np.array, arrays), *constants)[1](jax.tree.map(np.array, dy))
        return gradients[: len(arrays)] if isinstance(gradients, tuple) else (gradients,)

    @jax.custom_vjp
    def wrapped(*arrays):
        return jax.pure_callback(value_of, shapes, *arrays)

    def forward(*arrays):
        return wrapped(*arrays), arrays

    def backward(arrays, dy):
        like = tuple(jax.ShapeDtypeStruct(a.shape, a.dtype) for a in arrays)
        return jax.pure_callback(pulled, like, dy, *arrays)

    wrapped.defvjp(forward, backward)
    try:
        check_grads(wrapped, tuple(map(jax.numpy.asarray, floats)), order=1, modes=["rev"])
    except AssertionError:
        return False
    return True


def passes_autograd(f: Callable, inputs: tuple) -> bool:
    from autograd.builtins import tuple as boxed_tuple
    from autograd.extend import defvjp, primitive
    from autograd.test_util import check_grads

    floats = [x for x in inputs if np.issubdtype(x.dtype, np.floating)]
    constants = inputs[len(floats) :]
    is_tuple = isinstance(f(*inputs)[0], tuple)

    @primitive
    def wrapped(*arrays):
        value = f(*arrays, *constants)[0]
        return boxed_tuple(value) if is_tuple else value

    def pulled(i: int) -> Callable:
        def of(value, *arrays):
            def pullback(dy):
                gradients = f(*arrays, *constants)[1](dy)
                return gradients[i] if isinstance(gradients, tuple) else gradients

            return pullback

        return of

    defvjp(wrapped, *(pulled(i) for i in range(len(floats))))
    try:
        check_grads(wrapped, tuple(range(len(floats))), modes=["rev"], order=1)(*floats)
    except AssertionError:
        return False
    return True


def with_arrays(f: Callable, inputs: tuple) -> tuple[Callable, tuple]:
    """f as a function of the arrays and numbers in its inputs, one gradient for each of them."""
    arrays = [leaf for x in inputs for _, leaf in leaves("", x)]
    if all(isinstance(x, np.ndarray) for x in inputs):
        return f, inputs

    def of_arrays(*arrays):
        value, pullback = f(*rebuild(inputs, iter(arrays)))
        return value, lambda dy: tuple(leaf for _, leaf in leaves("", pullback(dy)))

    return of_arrays, tuple(map(np.array, arrays))


CHECKS = {
    "check_gradients": passes_check_gradients,
    "gradcheck": passes_gradcheck,
    "jax": passes_jax,
    "autograd": passes_autograd,
}


def has_properties(f: Callable, published: PublishedOperation) -> bool:
    """Whether every property holds; nothing but the shapes and the domain is known of f.

    Small projects do not promise to keep float32.
    """
    skip = ("dtype",) if published.is_layer else ()
    properties = verify.properties_of(
        f, published.shapes, values=published.ranges, skip=skip, dtypes=published.dtypes
    )
    for stated in properties:
        try:
            verify.check_property(stated, f)
        except AssertionError:
            return False
    return True


def passes_with_ones(f: Callable, inputs: tuple) -> bool:
    """Stanford's CS231n: `eval_numerical_gradient_array(f, x, df)` with ones for df.

    The differences, with steps of 1e-5, are those of the sum of the outputs. (The notebooks of the
    course pass random numbers for df; ones are what `y.sum().backward()` passes.)
    """
    value, pullback = f(*inputs)
    df = np.ones_like(value)
    pulled = pullback(df.copy())
    gradients = pulled if isinstance(pulled, tuple) else (pulled,)
    for x, gradient in zip(inputs, gradients, strict=True):
        numeric = np.zeros_like(x)
        for entry in np.ndindex(x.shape):
            value = x[entry]
            x[entry] = value + 1e-5
            ahead = np.copy(f(*inputs)[0])
            x[entry] = value - 1e-5
            behind = np.copy(f(*inputs)[0])
            x[entry] = value
            numeric[entry] = np.sum((ahead - behind) * df) / 2e-5
        if numeric.shape != gradient.shape or not np.allclose(numeric, gradient):
            return False
    return True


CHECKS_OF_PUBLISHED: dict[str, Callable] = {
    "properties": has_properties,
    **CHECKS,
    "all ones": passes_with_ones,
}
"""The checks that are tried on published operations: also the properties of
`verify.properties_of`, and differences of the sum of the outputs."""


def accepts(check: str, published: PublishedOperation, fixed: bool) -> bool | None:
    """Whether a check accepts a version of an operation; None if the check is not installed."""
    f = published.version(fixed)
    np.random.seed(0)  # noqa: NPY002 (autograd draws from it)
    try:
        if check == "properties":
            return has_properties(f, published)
        return CHECKS_OF_PUBLISHED[check](f, published.inputs())
    except ImportError:
        return None
    except Exception:
        return False


def run() -> Result:
    """Try every check on every function, every layer and every historical bug."""
    warnings.simplefilter("ignore")
    return Result("Checks of gradients", [try_functions(), try_layers(), *try_bugs()])


def try_functions() -> Table:
    """A row for each function, and how often each check was right."""
    rows = []
    for word, cases in (("right", RIGHT), ("wrong", WRONG)):
        for name, case in cases.items():
            verdicts = [judge(check, case, word == "right") for check in CHECKS.values()]
            rows.append([name, word, *verdicts])
    return count_right("function", list(CHECKS), rows)


def try_layers() -> Table:
    """A row for each layer of a small project, in the version that the project has."""
    rows = []
    for layer in layers():
        verdicts = []
        for check in CHECKS_OF_PUBLISHED:
            accepted = accepts(check, layer, fixed=False)
            if accepted is None:
                verdicts.append("not installed")
            else:
                verdicts.append(verdict(accepted, layer.is_right))
        word = "right" if layer.is_right else "wrong"
        link = f"[{layer.project}, {layer.operation}]({layer.thread})"
        rows.append([link, word, *verdicts])
    return count_right("layer", list(CHECKS_OF_PUBLISHED), rows)


def count_right(heading: str, checks: list[str], rows: list[list[str]]) -> Table:
    """A table of verdicts, whose last row has how many of them were right."""
    counts = []
    for column in range(2, 2 + len(checks)):
        count = sum(row[column] == "right" for row in rows)
        counts.append(count or "not installed")
    last = [f"right of {len(rows)}", "", *counts]
    return Table("", [heading, "pullback", *checks], [*rows, last])


def try_bugs() -> list[Table]:
    """A row for each bug, with the checks that miss it, and what each check found and refused."""
    bugs = historical_bugs()
    number_found = dict.fromkeys(CHECKS_OF_PUBLISHED, 0)
    number_refused = dict.fromkeys(CHECKS_OF_PUBLISHED, 0)
    rows = []
    for bug in bugs:
        missed_by = []
        for check in CHECKS_OF_PUBLISHED:
            accepted = accepts(check, bug, fixed=False)
            if accepted:
                missed_by.append(check)
            if accepted is False:
                number_found[check] += 1
            if accepts(check, bug, fixed=True) is False:
                number_refused[check] += 1
        links = f"[{bug.project}, {bug.operation}]({bug.thread}) ([fix]({bug.fix}))"
        rows.append([links, bug.mistake, ", ".join(missed_by)])
    of_all = f"of {len(bugs)}"
    header = ["check", f"wrong ones found, {of_all}", f"right ones refused, {of_all}"]
    counts = []
    for check in CHECKS_OF_PUBLISHED:
        counts.append([check, number_found[check] or "not installed", number_refused[check]])
    return [Table("", ["wrong gradient", "mistake", "missed by"], rows), Table("", header, counts)]


def judge(check: Callable, case: tuple, is_right: bool) -> str:
    """What a check says of a case."""
    f, *inputs = case
    np.random.seed(0)  # noqa: NPY002 (autograd draws from it)
    try:
        if check is not passes_check_gradients:
            f, inputs = with_arrays(f, tuple(inputs))
        accepted = check(f, tuple(deepcopy(inputs)))
    except ImportError:
        return "not installed"
    except Exception as error:
        return type(error).__name__
    return verdict(accepted, is_right)


def verdict(accepted: bool, is_right: bool) -> str:
    """Whether a check that accepts or refuses a pullback is right."""
    if accepted == is_right:
        return "right"
    return "false alarm" if is_right else "missed"
