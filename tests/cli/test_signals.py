"""Ctrl-C at any moment of a command: one line, status 130."""

import os
import signal
import subprocess
import sys
import time

import pytest

BEGIN = """
import builtins, os, signal, sys
from numpy_cae.__main__ import main
import_module = builtins.__import__
def interrupted_import(name, *arguments, **options):
    if name.split(".")[0] == {name!r} or name == {name!r}:
        os.kill(os.getpid(), signal.SIGINT)
    return import_module(name, *arguments, **options)
builtins.__import__ = interrupted_import
sys.argv = ["numpy-cae", "rig", "missing.bvh"]
sys.exit(main())
"""
HEAR = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
"""A command in the foreground hears interrupts, also where the tests run in the background."""


@pytest.mark.parametrize("name", ["argparse", "numpy", "numpy_cae.mocap", "numpy_cae.cli"])
def test_an_interrupt_while_modules_are_imported_is_one_line(name):
    program = [sys.executable, "-c", HEAR + BEGIN.format(name=name)]
    ended = subprocess.run(program, capture_output=True, text=True, timeout=100)
    assert ended.stderr == "numpy-cae: interrupted; nothing was written\n"
    assert ended.returncode == 130


def test_an_ignored_interrupt_stays_ignored():
    """As of a command that a shell runs in the background."""
    ignore = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)"
    program = [sys.executable, "-c", ignore + BEGIN.format(name="argparse")]
    ended = subprocess.run(program, capture_output=True, text=True, timeout=100)
    assert "missing.bvh" in ended.stderr
    assert ended.returncode == 2


def test_little_is_imported_before_interrupts_are_handled():
    """What is imported earlier ends in a traceback if Ctrl-C comes then."""
    show = "import sys; import os, importlib; before = set(sys.modules); import numpy_cae.__main__"
    show += "; print(*sorted(set(sys.modules) - before))"
    program = [sys.executable, "-c", show]
    ended = subprocess.run(program, capture_output=True, text=True, timeout=100)
    assert ended.stdout.split() == ["numpy_cae", "numpy_cae.__main__"]


@pytest.mark.parametrize("moment", ["while it says so", "after the command"])
def test_an_interrupt_after_the_command_says_nothing(moment):
    command = "raise KeyboardInterrupt" if moment == "while it says so" else "return 0"
    program = f"""
import os, signal
import numpy_cae.cli
from numpy_cae.__main__ import main
def command():
    {command}
numpy_cae.cli.main = command
status = main()
os.kill(os.getpid(), signal.SIGINT)
"""
    ended = subprocess.run(
        [sys.executable, "-c", HEAR + program], capture_output=True, text=True, timeout=100
    )
    assert ended.stderr == ""
    assert ended.returncode == 130


@pytest.mark.thorough
@pytest.mark.parametrize("number", range(40))
def test_an_interrupt_at_any_moment_is_one_line(number, tmp_path):
    from data_synth import make_take
    from numpy_cae.mocap import write_bvh

    write_bvh(make_take("walk", 0, seconds=4.0, rate=30.0).motion, tmp_path / "walk.bvh")
    words = "repair walk.bvh -o out.bvh --html --findings found.json".split()
    # While Python itself starts, which takes longer on a busy machine, nobody can handle a signal.
    begin = "import sys; from numpy_cae.__main__ import main; print('begun', flush=True); "
    program = [sys.executable, "-c", HEAR + "; " + begin + "sys.exit(main())", *words]
    pipe = subprocess.PIPE
    with subprocess.Popen(program, stdout=pipe, stderr=pipe, text=True, cwd=tmp_path) as process:
        assert process.stdout.readline() == "begun\n"
        time.sleep(0.01 + 0.05 * number)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=100)
    # While Python itself ends, the signal ends it.
    assert process.returncode in (0, 3, 4, 130, -signal.SIGINT)
    assert "Traceback" not in said
    assert not [name for name in os.listdir(tmp_path) if ".part" in name]
