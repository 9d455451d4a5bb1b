"""The running IPython, which nobody has to have."""

import sys


def shell():
    """The running IPython; None in plain Python."""
    ipython = sys.modules.get("IPython")
    return ipython and ipython.get_ipython()
