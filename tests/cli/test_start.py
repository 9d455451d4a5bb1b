"""Starting the command line: what it imports, and what it prints without a subcommand."""

from __future__ import annotations

import subprocess
import sys

import numpy_cae
from numpy_cae.cli import SUBCOMMANDS


def run_python(*words):
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, check=True)


def test_importing_the_command_line_imports_nothing_heavy():
    code = "import sys, numpy_cae.cli; print(*sys.modules)"
    imported = set(run_python("-c", code).stdout.split())
    assert not imported & {"numpy", "scipy", "matplotlib", "torch", "data_synth"}


def test_help_lists_every_subcommand_and_imports_none():
    code = (
        "import sys\nfrom numpy_cae.cli import main\n"
        "try: main(['--help'])\nexcept SystemExit: print(*sys.modules)"
    )
    said = run_python("-c", code).stdout
    assert all(f"    {name} " in said for name in SUBCOMMANDS)
    assert not set(said.split()) & {"numpy", "scipy", "matplotlib", "numpy_cae.cli.train"}


def test_it_runs_as_a_module_and_prints_its_version():
    assert run_python("-m", "numpy_cae", "--version").stdout.split()[1] == numpy_cae.__version__
