"""Learning motion manifolds, every derivative by hand.

Two papers, implemented in NumPy without an automatic differentiation framework:

- holden2015: Holden, Saito, Komura and Joyce, "Learning Motion Manifolds with Convolutional
  Autoencoders", SIGGRAPH Asia 2015 Technical Briefs.
- jang2018: Jang and Lee, "Latent Motion Manifold with Sequential Auto-Encoders", SCA 2018 posters.

Start reading in `numpy_cae.ops`; `docs/map.md` lists where each equation of the papers is. The
functions `load`, `save`, `project`, `fill`, `show` and `learn` are those of `numpy_cae.public`, and
`numpy_cae.repair` is a package that can be called. All are imported when they are first used.
"""

from importlib import import_module as _import_module
from pkgutil import iter_modules as _iter_modules

from numpy_cae import notebook as _notebook

__version__ = "0.4.0"
__all__ = ["fill", "learn", "load", "project", "repair", "save", "show"]

_notebook.register()


def __dir__() -> list[str]:
    packages = [name for _, name, is_package in _iter_modules(__path__) if is_package]
    return sorted({*__all__, *packages, "__version__"})


def __getattr__(name: str) -> object:
    if name in __all__ and name != "repair":
        return getattr(_import_module("numpy_cae.public"), name)
    try:
        return _import_module(f"numpy_cae.{name}")
    except ModuleNotFoundError as error:
        if error.name != f"numpy_cae.{name}":
            raise
        raise AttributeError(f"numpy_cae has no {name!r}") from None
