"""A command of `numpy-cae` that prints its process's status at its end, which has its peak memory.

python -m studies.timing.peak_memory repair take.bvh -o fixed.bvh       # on Linux
"""

import atexit
import runpy
import sys
from pathlib import Path


def print_status() -> None:
    """Print what Linux knows of this process, such as VmHWM, on standard error."""
    print(Path("/proc/self/status").read_text("utf-8"), file=sys.stderr)


if __name__ == "__main__":
    atexit.register(print_status)
    runpy.run_module("numpy_cae", run_name="__main__")
