"""Learning motion manifolds, every derivative by hand.

Two papers, implemented in NumPy without an automatic differentiation framework:

- holden2015: Holden, Saito, Komura and Joyce, "Learning Motion Manifolds with Convolutional
  Autoencoders", SIGGRAPH Asia 2015 Technical Briefs.
- jang2018: Jang and Lee, "Latent Motion Manifold with Sequential Auto-Encoders", SCA 2018 posters.

Start reading in `numpy_cae.ops`; `docs/map.md` lists where each equation of the papers is. The
functions listed in `__all__` are defined in `numpy_cae.public`. Functions and packages are imported
when they are first used.
"""

import sys as _sys
from importlib import import_module as _import_module

TYPE_CHECKING = False  # as in `typing`, whose import takes longer than all of this file
if TYPE_CHECKING:  # editors and type checkers learn here what __getattr__ imports
    from numpy_cae import (
        cleanup,
        course,
        evaluation,
        fast,
        manifold,
        mocap,
        models,
        motion,
        ops,
        training,
        verify,
        viz,
    )
    from numpy_cae.public import fill, learn, load, project, repair, save, show

__version__ = "0.4.0"
__all__ = [
    "__version__",
    "cleanup",
    "course",
    "evaluation",
    "fast",
    "fill",
    "learn",
    "load",
    "manifold",
    "mocap",
    "models",
    "motion",
    "ops",
    "project",
    "repair",
    "save",
    "show",
    "training",
    "verify",
    "viz",
]
_FUNCTIONS = ("fill", "learn", "load", "project", "repair", "save", "show")

if "IPython" in _sys.modules:  # plain Python imports nothing more
    from numpy_cae import notebook as _notebook

    _notebook.register()


def __dir__() -> list[str]:
    return __all__


if not TYPE_CHECKING:  # a type checker would accept any name

    def __getattr__(name: str) -> object:
        if name in _FUNCTIONS:
            return getattr(_import_module("numpy_cae.public"), name)
        try:
            return _import_module(f"numpy_cae.{name}")
        except ModuleNotFoundError as error:
            if error.name != f"numpy_cae.{name}":
                raise
            raise AttributeError(f"numpy_cae has no {name!r}") from None
