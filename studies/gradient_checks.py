"""`check_gradients` compared with the checks of PyTorch, JAX and autograd, as far as installed.

Functions with pullbacks written in NumPy, right and wrong, are wrapped for each library and checked
with its default settings (in reverse mode, which alone uses the pullback). Then the layers of small
projects in NumPy are tried as they are, and both versions, the wrong and the fixed one, of the
wrong gradients that libraries really had, also with the properties of `verify.properties_of` and
with differences of the sum of the outputs.
docs/verify.md and docs/historical_gradients.md have the tables:

    python -m studies gradient_checks
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from copy import deepcopy

import numpy as np

from numpy_cae import verify
from numpy_cae.verify import check_gradients
from numpy_cae.verify.checks.call import leaves, rebuilt
from studies.gradients.bugs import LAYERS, Bug, bugs
from studies.gradients.cases import RIGHT, WRONG
from studies.shared.result import Result, Table


def by_numpy_cae(f: Callable, inputs: tuple) -> bool:
    try:
        check_gradients(f, *inputs)
    except (AssertionError, TypeError):  # a TypeError says that it cannot be checked
        return False
    return True


def by_torch(f: Callable, inputs: tuple) -> bool:
    import torch

    class Wrapped(torch.autograd.Function):
        @staticmethod
        def forward(context, *tensors):
            value, context.pullback = f(*(t.detach().numpy() for t in tensors))
            parts = value if isinstance(value, tuple) else (value,)
            made = tuple(torch.from_numpy(np.array(part)) for part in parts)
            return made if isinstance(value, tuple) else made[0]

        @staticmethod
        def backward(context, *dys):
            given = [dy.detach().numpy() for dy in dys]
            pulled = context.pullback(tuple(given) if len(given) > 1 else given[0])
            pulled = pulled if isinstance(pulled, tuple) else (pulled,)
            gradients = [torch.from_numpy(np.array(gradient)) for gradient in pulled]
            return (*gradients, *[None] * (len(inputs) - len(gradients)))

    tensors = [torch.from_numpy(np.array(x)) for x in inputs]
    tensors = [t.requires_grad_() if t.is_floating_point() else t for t in tensors]
    return torch.autograd.gradcheck(Wrapped.apply, tensors, raise_exception=False)


def by_jax(f: Callable, inputs: tuple) -> bool:
    import jax
    from jax.test_util import check_grads

    jax.config.update("jax_enable_x64", True)
    value = f(*inputs)[0]
    shapes = jax.tree.map(lambda y: jax.ShapeDtypeStruct(np.shape(y), np.asarray(y).dtype), value)
    floats = [x for x in inputs if np.issubdtype(x.dtype, np.floating)]
    others = inputs[len(floats) :]

    def value_of(*arrays):
        return f(*map(np.array, arrays), *others)[0]

    def pulled(dy, *arrays):
        made = f(*map(np.array, arrays), *others)[1](jax.tree.map(np.array, dy))
        return made[: len(arrays)] if isinstance(made, tuple) else (made,)

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


def by_autograd(f: Callable, inputs: tuple) -> bool:
    from autograd.builtins import tuple as boxed_tuple
    from autograd.extend import defvjp, primitive
    from autograd.test_util import check_grads

    floats = [x for x in inputs if np.issubdtype(x.dtype, np.floating)]
    others = inputs[len(floats) :]
    is_tuple = isinstance(f(*inputs)[0], tuple)

    @primitive
    def wrapped(*arrays):
        value = f(*arrays, *others)[0]
        return boxed_tuple(value) if is_tuple else value

    def pulled(i: int) -> Callable:
        def of(value, *arrays):
            def pullback(dy):
                made = f(*arrays, *others)[1](dy)
                return made[i] if isinstance(made, tuple) else made

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
        value, pullback = f(*rebuilt(inputs, iter(arrays)))
        return value, lambda dy: tuple(leaf for _, leaf in leaves("", pullback(dy)))

    return of_arrays, tuple(map(np.array, arrays))


CHECKS = {
    "check_gradients": by_numpy_cae,
    "gradcheck": by_torch,
    "jax": by_jax,
    "autograd": by_autograd,
}


def by_properties(f: Callable, bug: Bug) -> bool:
    """Whether every property holds; nothing but the shapes and the domain is known of f.

    Small projects do not promise to keep float32.
    """
    options = {"skip": ("dtype",) if bug.is_layer else (), "dtypes": bug.dtypes}
    for stated in verify.properties_of(f, bug.shapes, values=bug.ranges, **options):
        try:
            verify.check_property(stated, f)
        except AssertionError:
            return False
    return True


def by_ones(f: Callable, inputs: tuple) -> bool:
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
            kept = x[entry]
            x[entry] = kept + 1e-5
            ahead = np.copy(f(*inputs)[0])
            x[entry] = kept - 1e-5
            behind = np.copy(f(*inputs)[0])
            x[entry] = kept
            numeric[entry] = np.sum((ahead - behind) * df) / 2e-5
        if numeric.shape != gradient.shape or not np.allclose(numeric, gradient):
            return False
    return True


ON_BUGS: dict[str, Callable] = {"properties": by_properties, **CHECKS, "all ones": by_ones}
"""The checks that are tried on the wrong gradients of libraries: also the properties of
`verify.properties_of`, and differences of the sum of the outputs."""


def verdict(check: str, bug: Bug, fixed: bool) -> bool | None:
    """Whether a check accepts a version of a bug's operation; None if it is not installed."""
    f = bug.function(fixed)
    np.random.seed(0)  # noqa: NPY002 (autograd draws from it)
    try:
        return ON_BUGS[check](f, bug if check == "properties" else bug.inputs())
    except ImportError:
        return None
    except Exception:
        return False


def run() -> Result:
    """Try every check on every function and every bug."""
    warnings.simplefilter("ignore")
    return Result("Checks of gradients", [_on_functions(), _on_layers(), *_on_bugs()])


def _on_functions() -> Table:
    """A row for each function, and how often each check was right."""
    rows = []
    for word, cases in (("right", RIGHT), ("wrong", WRONG)):
        for name, case in cases.items():
            verdicts = (judged(check, case, word == "right") for check in CHECKS.values())
            rows.append([name, word, *verdicts])
    return _counted("function", list(CHECKS), rows)


def _on_layers() -> Table:
    """A row for each layer of a small project, in the version that the project has."""
    rows = []
    for layer in bugs(LAYERS):
        said = [verdict(check, layer, fixed=False) for check in ON_BUGS]
        words = {layer.is_right: "right", not layer.is_right: "false alarm", None: "not installed"}
        words |= {} if layer.is_right else {True: "missed"}
        project, operation, thread = (layer.fields[n] for n in ("project", "operation", "thread"))
        word = "right" if layer.is_right else "wrong"
        rows.append([f"[{project}, {operation}]({thread})", word, *(words[each] for each in said)])
    return _counted("layer", list(ON_BUGS), rows)


def _counted(what: str, checks: list[str], rows: list[list[str]]) -> Table:
    """A table of verdicts, whose last row has how many of them were right."""
    counts = [sum(row[2 + i] == "right" for row in rows) for i in range(len(checks))]
    last = [f"right of {len(rows)}", "", *(count or "not installed" for count in counts)]
    return Table("", [what, "pullback", *checks], [*rows, last])


def _on_bugs() -> list[Table]:
    """A row for each bug, with the checks that miss it, and what each check found and refused."""
    found = dict.fromkeys(ON_BUGS, 0)
    refused = dict.fromkeys(ON_BUGS, 0)
    rows = []
    every = bugs()
    for bug in every:
        missed = []
        for check in ON_BUGS:
            accepted = verdict(check, bug, fixed=False)
            missed += [check] if accepted else []
            found[check] += accepted is False
            refused[check] += verdict(check, bug, fixed=True) is False
        project, thread, fix = (bug.fields[name] for name in ("project", "thread", "fix"))
        links = f"[{project}, {bug.fields['operation']}]({thread}) ([fix]({fix}))"
        rows.append([links, bug.fields["mistake"], ", ".join(missed)])
    of = f"of {len(every)}"
    header = ["check", f"wrong ones found, {of}", f"right ones refused, {of}"]
    counts = [[name, found[name] or "not installed", refused[name]] for name in ON_BUGS]
    return [Table("", ["wrong gradient", "mistake", "missed by"], rows), Table("", header, counts)]


def judged(check: Callable, case: tuple, is_right: bool) -> str:
    """What a check makes of a case."""
    f, *inputs = case
    np.random.seed(0)  # noqa: NPY002 (autograd draws from it)
    try:
        if check is not by_numpy_cae:
            f, inputs = with_arrays(f, tuple(inputs))
        passed = check(f, tuple(deepcopy(inputs)))
    except ImportError:
        return "not installed"
    except Exception as error:
        return type(error).__name__
    if passed == is_right:
        return "right"
    return "false alarm" if is_right else "missed"
