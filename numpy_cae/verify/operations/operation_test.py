"""The decorator that makes a function of a test file one test for each of its properties."""

from collections.abc import Callable, Mapping

from numpy_cae.verify.operations.catalogue import properties_of


def operation_test(
    shapes: Mapping[str, str], definition: Callable | None = None, **options
) -> Callable[[Callable], Callable]:
    """Make a test of each property of an operation, in a test file of pytest.

    The tests are collected by the plugin `numpy_cae.pytest_plugin`, which pytest finds where
    numpy_cae is installed. A test that fails shows what is wrong and the smallest counterexample
    with its seed.

    Parameters
    ----------
    shapes, definition, **options
        Those of `properties_of`.

    Returns
    -------
    callable
        A decorator of a function in the form of `numpy_cae.ops`; it returns the function itself.

    Raises
    ------
    ValueError
        As `properties_of` does.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae import verify
    >>> @verify.operation_test(shapes={"x": "..."})
    ... def test_square(x):
    ...     return x * x, lambda dy: 2 * x * dy
    >>> len(test_square.operation_test)
    6
    """

    def with_properties(f: Callable) -> Callable:
        f.operation_test = properties_of(f, shapes, definition, **options)  # type: ignore[attr-defined]
        return f

    return with_properties
