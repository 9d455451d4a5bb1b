"""Print what the networks and the baselines make of the published protocol.

PYTHONPATH=docs python -m cmu35 ../shared/data/cmu35
"""

import sys

from cmu35.experiment import run

if __name__ == "__main__":
    print(run(sys.argv[1:]).text())
