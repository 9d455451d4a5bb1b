"""Pieces of files that are handed in, right, wrong and hostile: name to text."""

import re
from pathlib import Path

TEXT = Path(__file__).with_suffix(".txt").read_text("utf-8")
PIECES = dict(re.findall(r"^== (\w+)\n(.*?)(?=^== |\Z)", TEXT, re.DOTALL | re.MULTILINE))
