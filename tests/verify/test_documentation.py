"""The test file in docs/verify.md runs, and finds a mistake in the GRU beside it."""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def run_tests(folder, *options):
    command = [sys.executable, *"-m pytest -q -p no:cacheprovider test_my_gru.py".split(), *options]
    paths = {"PYTHONPATH": os.pathsep.join([str(ROOT), str(folder)]), "OPENBLAS_NUM_THREADS": "1"}
    ran = subprocess.run(command, cwd=folder, env={**os.environ, **paths}, capture_output=True)
    return ran.returncode, ran.stdout.decode()


def test_the_test_file_of_the_guide_passes_and_finds_a_mistake(tmp_path):
    text = (ROOT / "docs" / "verify.md").read_text(encoding="utf-8")
    for block in re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE):
        (tmp_path / block.partition("\n")[0].removeprefix("# ")).write_text(block)
    status, output = run_tests(tmp_path, "-k", "value or gradient or network")
    assert status == 0 and "passed" in output, output
    source = (tmp_path / "my_gru.py").read_text()
    (tmp_path / "my_gru.py").write_text(source.replace("1 - n * n", "1 - n"))
    status, output = run_tests(tmp_path, "-k", "value or w")
    assert status == 1 and "test_gru[value]" not in output
    assert "test_gru[gradient for w]" in output and "test_network[w]" in output
    assert "test_network[out_w]" not in output
