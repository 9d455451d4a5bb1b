"""Messages of a study while it runs."""

import sys


def note(text: str) -> None:
    """Print a message on standard error, which keeps standard output for results."""
    print(text, file=sys.stderr, flush=True)
