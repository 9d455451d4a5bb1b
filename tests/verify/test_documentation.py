"""The test file in docs/verify.md finds a mistake in the GRU beside it."""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def run_tests(folder, *names):
    """Run these tests in a fresh process, without the plugins that take most of its time."""
    command = [sys.executable, *"-m pytest -q --tb=no -p no:cacheprovider".split()]
    paths = {"PYTHONPATH": os.pathsep.join([str(ROOT), str(folder)]), "OPENBLAS_NUM_THREADS": "1"}
    environment = {**os.environ, **paths, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    tests = [f"test_my_gru.py::{name}" for name in names]
    ran = subprocess.run([*command, *tests], cwd=folder, env=environment, capture_output=True)
    return ran.stdout.decode()


def test_the_test_file_of_the_guide_finds_a_mistake(tmp_path):
    text = (ROOT / "docs" / "verify.md").read_text(encoding="utf-8")
    for block in re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE):
        (tmp_path / block.partition("\n")[0].removeprefix("# ")).write_text(block)
    source = (tmp_path / "my_gru.py").read_text()
    (tmp_path / "my_gru.py").write_text(source.replace("1 - n * n", "1 - n"))
    right = ["test_gru[value]", "test_network[out_w]"]
    output = run_tests(tmp_path, *right, "test_gru[gradient for w]", "test_network[w]")
    assert "2 failed, 2 passed" in output and "test_gru[value]" not in output, output
    assert "test_gru[gradient for w]" in output and "test_network[w]" in output
