"""`python -m numpy_cae` is `numpy-cae`."""

import sys

from numpy_cae.cli import main

sys.exit(main())
