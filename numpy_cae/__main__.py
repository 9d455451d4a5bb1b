"""`numpy-cae` and `python -m numpy_cae`.

The imports of a command take a second. Ctrl-C in this time ends the process at once, with one line:
nothing is written yet, and an exception inside of an import may turn into another one. So nothing
that takes time is imported before Ctrl-C is handled: `_signal` is a part of Python's executable,
while `signal` makes its enumerations first.
"""

import _signal
import os
import sys


def main() -> int:
    """Run the command line; return its exit status."""
    _handle_interrupts(_end)
    from numpy_cae.cli import main as run_command

    try:
        return run_command()
    except KeyboardInterrupt:  # Ctrl-C again, while the command says that it was interrupted
        return 130
    finally:
        _handle_interrupts(_leave)


def _handle_interrupts(handler: object) -> None:
    """Call `handler` after Ctrl-C, unless it is ignored, as in a command that a shell runs in the
    background."""
    if _signal.getsignal(_signal.SIGINT) is not _signal.SIG_IGN:
        _signal.signal(_signal.SIGINT, handler)


def _end(*_: object) -> None:
    """End the process as after Ctrl-C; `numpy_cae.cli` takes over when it runs a command."""
    os.write(2, b"numpy-cae: interrupted; nothing was written\n")
    os._exit(130)


def _leave(*_: object) -> None:
    """End the process, whose command has ended and said what it wrote."""
    os._exit(130)


if __name__ == "__main__":
    sys.exit(main())
