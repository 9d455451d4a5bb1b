"""The plugin of pytest in a project of its own, and properties of an operation of one's own."""

import configparser
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from numpy_cae import ops, verify
from numpy_cae.verify.operations.trial import failing_case

ROOT = Path(__file__).parents[2]


def test_the_plugin_is_registered_and_imports_nothing_heavy():
    config = configparser.ConfigParser()
    config.read(ROOT / "setup.cfg")
    module = config["options.entry_points"]["pytest11"].partition("=")[2].strip()
    code = f"import sys, {module}; assert not {{'numpy', 'scipy', 'torch'}} & {{*sys.modules}}"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT).returncode == 0


SHAPES = {
    "linear": {"x": "... channels", "w": "channels features", "b": "features"},
    "max_pool": {"x": "batch 2*frames channels"},
}


@pytest.mark.parametrize("name", SHAPES)
def test_right_operations_hold_without_and_with_a_definition(name):
    f = getattr(ops, name)
    for definition in (None, f):
        stated = verify.properties_of(f, SHAPES[name], definition)
        assert ("value" in [each.name for each in stated]) == (definition is not None)
        assert [each.name for each in stated if failing_case(each, f)] == []


def softmax(x):
    e = np.exp(x - x.max(axis=-1, keepdims=True))
    y = e / e.sum(axis=-1, keepdims=True)
    return y, lambda dy: y * (dy - np.sum(dy * y, axis=-1, keepdims=True))


def clipped(x):
    y, pullback = softmax(x)
    return y, lambda dy: pullback(np.clip(dy, -7, 7))


def transposed(x):
    y, pullback = softmax(x)
    return y, lambda dy: pullback(dy.ravel(order="K").reshape(x.shape))


def in_float64(x):
    y, pullback = softmax(x)
    return y, lambda dy: pullback(dy).astype(float)


def kept(x, buffers={}):  # noqa: B006
    y, pullback = softmax(x)
    buffer = buffers.setdefault(x.shape, np.empty(x.shape, x.dtype))

    def pullback_into_buffer(dy):
        buffer[...] = pullback(dy)
        return buffer.astype(x.dtype, copy=False)

    return y, pullback_into_buffer


@pytest.mark.parametrize(
    ("f", "name"),
    [
        (softmax, ""),
        (clipped, "linearity"),
        (transposed, "strides"),
        (in_float64, "dtype"),
        (kept, "independence"),
        (lambda x: (softmax(x)[0], lambda dy: softmax(x)[0] * dy), "gradient for x"),
    ],
)
def test_a_wrong_operation_of_ones_own_fails_in_its_property(f, name):
    stated = verify.properties_of(f, {"x": "... classes"})
    failed = {each.name for each in stated if failing_case(each, f)}
    assert (name in failed) if name else (failed == set())


def test_names_that_shapes_does_not_have_are_refused():
    with pytest.raises(ValueError, match="softmax: shapes has no taps, only x"):
        verify.properties_of(softmax, {"x": "batch classes"}, sizes={"taps": (1, 3)})


TORCH = '''
import numpy as np
import pytest
import torch
from numpy_cae import verify


class Cube(torch.autograd.Function):
    """scale · x³"""

    @staticmethod
    def forward(context, x, scale):
        context.save_for_backward(x, scale)
        return scale * x**3

    @staticmethod
    def backward(context, dy):
        x, scale = context.saved_tensors
        return dy * scale * 3 * x**2, (dy * x**3).mean(0)


def of_torch(function, *arrays):
    tensors = [torch.from_numpy(np.array(a)).requires_grad_() for a in arrays]
    y = function(*tensors)

    def pullback(dy):
        upstream = torch.from_numpy(np.array(dy))
        gradients = torch.autograd.grad(y, tensors, upstream, retain_graph=True)
        return tuple(gradient.numpy() for gradient in gradients)

    return y.detach().numpy(), pullback


@verify.operation_test(shapes={"x": "batch channels", "scale": "channels"})
def test_cube(x, scale):
    return of_torch(Cube.apply, x, scale)


@pytest.mark.skip
@verify.operation_test(shapes={"x": "..."})
def test_square(x):
    return x * x, lambda dy: dy * x
'''


def test_a_function_of_pytorch_in_a_project_of_its_own(tmp_path):
    pytest.importorskip("torch")
    (tmp_path / "test_cube.py").write_text(TORCH, encoding="utf-8")
    options = "-q -rA -p numpy_cae.pytest_plugin -p no:cacheprovider".split()
    command = [sys.executable, "-m", "pytest", *options]
    environment = {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
    ran = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    text = ran.stdout
    assert "1 failed, 6 passed, 6 skipped" in text, text + ran.stderr
    assert "FAILED test_cube.py::test_cube::gradient for scale" in text
    assert "PASSED test_cube.py::test_cube::gradient for x" in text
    report = text.partition("FAILURES")[2].partition("short test summary")[0]
    assert "batch 2, channels 1, seed 0" in report and "scale = [-1.0]" in report
    assert len(report.partition("PASSES")[0].splitlines()) < 20
