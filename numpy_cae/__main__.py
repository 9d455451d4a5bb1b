"""`numpy-cae` and `python -m numpy_cae`.

The imports of a command take a second. Ctrl-C in this time ends the process at once, with one line:
nothing is written yet, and an exception inside of an import may turn into another one.
"""

import os
import signal
import sys


def main() -> int:
    """Run the command line; return its exit status."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # else it is ignored
        signal.signal(signal.SIGINT, _end)
    from numpy_cae.cli import main as run_command

    return run_command()


def _end(*_: object) -> None:
    """End the process as after Ctrl-C; `numpy_cae.cli` takes over when it runs a command."""
    os.write(2, b"numpy-cae: interrupted; nothing was written\n")
    os._exit(130)


if __name__ == "__main__":
    sys.exit(main())
