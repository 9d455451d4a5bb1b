"""The plugin of pytest in a project of its own, and properties of an operation of one's own."""

import configparser
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from numpy_cae import ops, verify
from numpy_cae.verify.operations.trial import failing_case, try_property

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "own_operation.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n# (\S+)\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)


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
    buffer = buffers.setdefault((x.shape, x.dtype), np.empty(x.shape, x.dtype))

    def pullback_into_buffer(dy):
        buffer[...] = pullback(dy)
        return buffer

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
    assert [each.name for each in stated].index("strides") < [s.name for s in stated].index("dtype")
    if f is kept:
        outcome = try_property(stated[-1], f)
        assert outcome.mistake.startswith("Results are kept in one array")


def test_names_that_shapes_does_not_have_are_refused():
    with pytest.raises(ValueError, match="softmax: shapes has no taps, only x"):
        verify.properties_of(softmax, {"x": "batch classes"}, sizes={"taps": (1, 3)})


PROJECT = """
import numpy as np
import pytest
import torch
from adapters import of_layer, of_torch
from numpy_cae import verify


class Cube(torch.autograd.Function):
    @staticmethod
    def forward(context, x, scale):
        context.save_for_backward(x, scale)
        return scale * x**3

    @staticmethod
    def backward(context, dy):
        x, scale = context.saved_tensors
        return dy * scale * 3 * x**2, (dy * x**3).mean(0)


class Linear:
    def __init__(self, w):
        self.w, self.gradients = w, {"w": np.zeros_like(w)}

    def forward(self, x):
        self.x = x
        return x @ self.w

    def backward(self, dy):
        self.gradients["w"] += self.x.T @ dy
        return dy @ self.w.T


@verify.operation_test(shapes={"x": "batch channels", "scale": "channels"})
def test_cube(x, scale):
    return of_torch(Cube.apply, x, scale)


@verify.operation_test(shapes={"x": "batch channels", "w": "channels features"})
def test_linear(x, w):
    return of_layer(Linear(w), x)


@verify.operation_test(shapes={"x": "..."}, values={"x": (-1e4, 1.0)})
def test_sigmoid(x):
    y = 1 / (1 + np.exp(-x))
    return y, lambda dy: dy * y * (1 - y)


@pytest.mark.skip
@verify.operation_test(shapes={"x": "..."})
def test_square(x):
    return x * x, lambda dy: dy * x
"""


@pytest.mark.parametrize("library", ["jax", "mygrad"])
def test_adapters_for_libraries_that_may_be_installed(library):
    module = pytest.importorskip(library)
    if library == "jax":
        module.config.update("jax_enable_x64", True)
    adapters = {}
    exec(dict(BLOCKS)["adapters.py"], adapters)

    def cube(x, scale):
        return adapters[f"of_{library}"](lambda x, scale: scale * x * x * x, x, scale)

    stated = verify.properties_of(cube, {"x": "batch channels", "scale": "channels"})
    assert [each.name for each in stated if failing_case(each, cube)] == []


def test_the_page_for_ones_own_layer_and_its_adapters_in_a_project_of_its_own(tmp_path):
    pytest.importorskip("torch")
    for name, block in BLOCKS:
        (tmp_path / name).write_text(block)
    (tmp_path / "test_project.py").write_text(PROJECT)
    options = "-q -rA -p numpy_cae.pytest_plugin -p no:cacheprovider".split()
    environment = {
        "PYTHONPATH": str(ROOT),
        "OPENBLAS_NUM_THREADS": "1",
        "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
    }
    command = [sys.executable, "-m", "pytest", *options]
    ran = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    text = ran.stdout
    assert "1 failed, 27 passed, 6 skipped" in text, text + ran.stderr
    assert "FAILED test_project.py::test_cube[gradient for scale]" in text
    assert "RuntimeWarning: note: RuntimeWarning: overflow encountered in exp (line " in text
    named = re.findall(r"^(test_my_layer.py::.*)$", PAGE, re.MULTILINE)
    assert len(named) == 8 and all(f"PASSED {name}" in text for name in named)
    report = text.partition("FAILURES")[2].partition("short test summary")[0]
    assert "batch 2, channels 1, seed 0" in report and "scale = [-1.0]" in report
    assert len(report.partition("PASSES")[0].splitlines()) <= 30
