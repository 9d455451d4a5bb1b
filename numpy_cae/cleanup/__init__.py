"""Repair of motion files: find what is damaged, mend it, fill in what is missing.

`repair_motion` in `cleanup/repair.py` is where reading begins.
"""

from numpy_cae.cleanup.finding import Finding, write_findings
from numpy_cae.cleanup.presets import PRESETS, Preset
from numpy_cae.cleanup.projection import project_motion
from numpy_cae.cleanup.repair import fill_motion, repair_motion
from numpy_cae.cleanup.result import Repaired

__all__ = [
    "PRESETS",
    "Finding",
    "Preset",
    "Repaired",
    "fill_motion",
    "project_motion",
    "repair_motion",
    "write_findings",
]
