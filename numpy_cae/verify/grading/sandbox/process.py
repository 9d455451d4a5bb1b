"""The grader's side: start the process that tests a submission, and end it in time."""

import functools
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

STARTUP_SECONDS = 30.0
"""STARTUP_SECONDS: the grader's process may take this time (s) to import its modules."""
BUSY = 10
"""BUSY: the grader itself is ended after so many times the limits of all functions.

The limits that decide on marks do not count the time in which a process waits for a processor. This
one is for a grader that a student's file has stopped.
"""
PREFIX = "numpy_cae_grading_"
PROJECT = str(Path(__file__).parents[4])
KEPT = ("PATH", "HOME", "SYSTEMROOT", "LD_LIBRARY_PATH", "LANG")
LIBRARIES = ("OPENBLAS", "OMP", "MKL", "BLIS")
ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in LIBRARIES}
CHILD = [sys.executable, "-B", "-m", "numpy_cae.verify.grading.sandbox.child"]
BUBBLEWRAP = "bwrap --ro-bind / / --dev /dev --proc /proc --unshare-all --die-with-parent".split()


def run(request: dict) -> dict:
    """The reply of `child.main` to a request, or {"failed": why}."""
    environment = {name: os.environ[name] for name in KEPT if name in os.environ} | ONE_THREAD
    environment["PYTHONPATH"] = os.pathsep.join([PROJECT, os.environ.get("PYTHONPATH", "")])
    processes = len(request["wanted"]) + 1
    timeout = BUSY * (2 * request["seconds"] * processes + STARTUP_SECONDS)
    with tempfile.TemporaryDirectory(prefix=PREFIX, ignore_cleanup_errors=True) as folder:
        environment["TMPDIR"] = folder
        inside = [*BUBBLEWRAP, "--bind", folder, folder] if has_bubblewrap() else []
        options = {"cwd": folder, "env": environment, "start_new_session": True, "timeout": timeout}
        text = json.dumps(request).encode()
        try:
            ended = subprocess.run([*inside, *CHILD], input=text, capture_output=True, **options)
            return json.loads(ended.stdout)
        except (subprocess.TimeoutExpired, ValueError):
            return {"failed": "its grading ended without a reply"}


@functools.cache
def has_bubblewrap() -> bool:
    """Whether bubblewrap is installed and works here; it needs namespaces of its user."""
    if shutil.which("bwrap") is None:
        return False
    return subprocess.run([*BUBBLEWRAP, "true"], capture_output=True).returncode == 0
