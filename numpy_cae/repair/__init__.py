"""Repair of motion files: find what is damaged, mend it, fill in what is missing.

The package can be called: `numpy_cae.repair(motion)` is `numpy_cae.repair.repair` with the starter
model. So the name means the same before and after a module of this package was imported.
"""

import sys
from types import ModuleType

from numpy_cae.manifold import MotionManifold, starter
from numpy_cae.motion import Motion
from numpy_cae.repair.finding import Finding, write_findings
from numpy_cae.repair.presets import PRESETS, Preset
from numpy_cae.repair.project_motion import project_motion
from numpy_cae.repair.repair import fill_motion, repair
from numpy_cae.repair.repaired import Repaired


class _CallablePackage(ModuleType):
    """The package as a function.

    Python sets the attribute `numpy_cae.repair` to the package as soon as one of its modules is
    imported, so the function of that name has to be the package.
    """

    def __call__(
        self, motion: Motion, manifold: MotionManifold | None = None, **options
    ) -> Repaired:
        """Find what is damaged in a motion and fill it in; the rest of the motion is unchanged.

        Parameters
        ----------
        motion : Motion
            As `load` returns it.
        manifold : MotionManifold, optional
            As `learn` returns it; the starter model of the package where None.
        **options
            Of `numpy_cae.repair.repair`: `damaged`, `preset`, `findings`.

        Returns
        -------
        Repaired
            Its `motion` is the repaired one. Printed, it names the joints, frames and centimetres.

        Examples
        --------
        >>> import numpy_cae
        >>> from data_synth import make_take
        >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
        >>> motion.rotations[30, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
        >>> numpy_cae.repair(motion)  # doctest: +NORMALIZE_WHITESPACE
        left_wrist: frame 30: moved 27.9 cm, at most 27.9
        1 finding:
          1. left_elbow: frame 30: spike (73° from the frames before and after):
            27.9 cm, confidence 0.94
        """
        return repair(motion, manifold or starter(), **options)


__all__ = [name for name in dir() if not name.startswith("_") and name not in ("sys", "ModuleType")]

sys.modules[__name__].__class__ = _CallablePackage
