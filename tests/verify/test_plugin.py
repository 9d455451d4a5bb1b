"""The plugin of pytest in a project of its own, the page about it, and the guide's test file."""

import configparser
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from failing_properties import failing

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PAGE = (ROOT / "docs" / "own_operation.md").read_text(encoding="utf-8")
ADAPTERS_PAGE = (ROOT / "docs" / "layers_of_other_forms.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```python\n# (\S+)\n(.*?)^```", re.DOTALL | re.MULTILINE)
BLOCKS = BLOCK.findall(PAGE + ADAPTERS_PAGE)


def test_the_plugin_is_registered_and_imports_nothing_heavy():
    config = configparser.ConfigParser()
    config.read(ROOT / "setup.cfg")
    module = config["options.entry_points"]["pytest11"].partition("=")[2].strip()
    code = f"import sys, {module}; assert not {{'numpy', 'scipy', 'torch'}} & {{*sys.modules}}"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT).returncode == 0


@pytest.mark.parametrize("library", ["torch", "jax", "mygrad"])
def test_adapters_for_libraries_that_may_be_installed(library):
    module = pytest.importorskip(library)
    if library == "jax":
        module.config.update("jax_enable_x64", True)
    adapters = {}
    exec(dict(BLOCKS)["adapters.py"], adapters)

    def cube(x, scale):
        return adapters[f"of_{library}"](lambda x, scale: scale * x * x * x, x, scale)

    assert failing(cube, {"x": "batch channels", "scale": "channels"}) == []


def run_pytest(folder, *words):
    """What pytest prints, in a fresh process without the plugins that take most of its time."""
    paths = {"PYTHONPATH": os.pathsep.join([str(ROOT), str(folder)]), "OPENBLAS_NUM_THREADS": "1"}
    environment = {**os.environ, **paths, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    command = [sys.executable, *"-m pytest -q -p no:cacheprovider".split(), *words]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True).stdout.decode()


def test_the_test_file_of_the_guide_finds_a_mistake_in_the_gru_beside_it(tmp_path):
    text = (ROOT / "docs" / "verify.md").read_text(encoding="utf-8")
    for block in re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE):
        (tmp_path / block.partition("\n")[0].removeprefix("# ")).write_text(block)
    source = (tmp_path / "my_gru.py").read_text()
    (tmp_path / "my_gru.py").write_text(source.replace("1 - n * n", "1 - n"))
    names = "gru[value]", "network[out_w]", "gru[gradient for w]", "network[w]"
    output = run_pytest(tmp_path, "--tb=no", *(f"test_my_gru.py::test_{name}" for name in names))
    assert "2 failed, 2 passed" in output and "test_gru[value]" not in output, output
    assert "test_gru[gradient for w]" in output and "test_network[w]" in output


def test_the_page_for_ones_own_layer_and_a_project_of_its_own(tmp_path):
    for name, block in BLOCKS:
        (tmp_path / name).write_text(block)
    (tmp_path / "test_project.py").write_text((HERE / "plugin_project.py").read_text())
    text = run_pytest(tmp_path, "-rA", "-p", "numpy_cae.pytest_plugin")
    assert "9 failed, 41 passed, 7 skipped, 2 xfailed" in text, text
    assert "FAILED test_project.py::TestLayers::test_static[gradient for scale]" in text
    assert "RuntimeWarning: overflow encountered in exp" in text
    named = re.findall(r"^(test_my_layer.py::.*)$", PAGE, re.MULTILINE)
    assert len(named) == 9 and all(f"PASSED {name}" in text for name in named)
    report = text.partition("FAILURES")[2].partition("short test summary")[0]
    assert "batch 2, " in report and "scale = [-1.0, 1.0]" in report
    assert report.count("KeyError: 'lost' (test_project.py, line ") == 7
    assert report.count("as in an earlier test, KeyError") == 6
    assert "numpy_cae/verify" not in report


REFUSED = """
import unittest
from numpy_cae import verify

class TestOfUnittest(unittest.TestCase):
    @verify.operation_test(shapes={"x": "n"})
    def test_method(self, x):
        return 2 * x, lambda dy: 2 * dy

class TestClassMethod:
    @classmethod
    @verify.operation_test(shapes={"x": "n"})
    def test_of_class(cls, x):
        return 2 * x, lambda dy: 2 * dy

@verify.operation_test(shapes={"x": "n"})
async def test_coroutine(x):
    return 2 * x, lambda dy: 2 * dy

def test_beside_them():
    pass
"""


def test_what_cannot_be_a_test_of_each_property_is_refused_one_by_one(tmp_path):
    (tmp_path / "test_refused.py").write_text(REFUSED)
    text = run_pytest(tmp_path, "-p", "numpy_cae.pytest_plugin")
    needed = "operation_test needs a function, or a method of a plain class, not a"
    for refused in ("method of unittest.TestCase", "class method", "coroutine"):
        assert text.count(f"{needed} {refused}") >= 1, text
    assert "1 passed, 3 errors" in text and "Traceback" not in text, text
