"""`check_gradients` and the checks of PyTorch, JAX and autograd of an operation with its pullback.

Each returns True where it accepts the pullback, and raises ImportError where the library is not
installed.

Lists and dicts of arrays are passed on to the libraries entry by entry, and numbers as arrays
without axes (`with_arrays`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from numpy_cae import verify
from numpy_cae.verify import check_gradients
from numpy_cae.verify.checks.call import leaves, rebuilt
from studies.gradients.bugs import Bug


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
