"""The wrong gradients that deep learning libraries really had, re-enacted in NumPy.

Each file of `historical/` has the links to the public thread and to the fix, the shapes of the
arguments, and a function in which the lines with a minus are those of the wrong version and the
lines with a plus those of the fixed one.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).with_name("historical")
LAYERS = Path(__file__).with_name("layers")
"""LAYERS: layers of small projects in NumPy. A right one has no mistake, nor marked lines."""
SIZES = (6, 4, 5, 3, 2)
"""SIZES: the names in the shapes stand for these, in their order, in checks of one point."""


def in_memory_order(array: np.ndarray) -> np.ndarray:
    """The array as a kernel reads it that takes it for contiguous: the numbers behind its first.

    Where its memory ends, zeros follow.
    """
    owner = array
    while isinstance(owner.base, np.ndarray):
        owner = owner.base
    starts = [a.__array_interface__["data"][0] for a in (owner, array)]
    memory = owner.ravel(order="K")[(starts[1] - starts[0]) // array.itemsize :][: array.size]
    return np.append(memory, np.zeros(array.size - memory.size, array.dtype)).reshape(array.shape)


@dataclass(frozen=True)
class Bug:
    """A wrong gradient of a library, re-enacted."""

    name: str
    fields: dict[str, str]  # project, operation, thread, fix, mistake, shapes, values
    code: str

    is_layer: bool = False  # of a small project

    @property
    def is_right(self) -> bool:
        """Whether it is a layer without a mistake."""
        return "mistake" not in self.fields

    @property
    def dtypes(self) -> tuple[str, ...]:
        """The dtypes that the operation keeps."""
        return tuple(self.fields.get("dtypes", "float64 float32").split())

    @property
    def shapes(self) -> dict[str, str]:
        """The shape of each argument, such as {"x": "batch channels"}."""
        return self._pairs("shapes")

    @property
    def ranges(self) -> dict[str, tuple[float, ...]]:
        """The range of an argument, where it is not -2 to 2."""
        return {name: tuple(map(float, v.split())) for name, v in self._pairs("values").items()}

    def _pairs(self, field: str) -> dict[str, str]:
        pairs = (part.split("=") for part in self.fields.get(field, "").split(",") if part)
        return {name.strip(): text.strip() for name, text in pairs}

    def function(self, fixed: bool) -> Callable:
        """The operation, with the lines of the wrong or of the fixed version."""
        kept, dropped = ("+", "-") if fixed else ("-", "+")
        lines = [line for line in self.code.splitlines() if not line.startswith(dropped)]
        source = "\n".join(" " + line[1:] if line.startswith(kept) else line for line in lines)
        namespace = {"np": np, "in_memory_order": in_memory_order}
        exec(compile(source, f"<{self.name}>", "exec"), namespace)
        return namespace[re.match(r"def (\w+)", source)[1]]

    def inputs(self) -> tuple[np.ndarray, ...]:
        """Standard normal numbers: what the documentation of each library gives to its check."""
        rng = np.random.default_rng(0)
        names = dict.fromkeys(re.findall(r"[a-z]\w*", " ".join(self.shapes.values())))
        sizes = dict(zip(names, SIZES, strict=False))
        shapes = ([_size(text, sizes) for text in shape.split()] for shape in self.shapes.values())
        return tuple(rng.standard_normal(shape) for shape in shapes)


def _size(text: str, sizes: dict[str, int]) -> int:
    """A size such as 2*frames."""
    return math.prod(sizes.get(factor) or int(factor) for factor in text.split("*"))


def bugs(folder: Path = FOLDER) -> list[Bug]:
    """Every bug in a folder, in the order of the names."""
    return [_read(path) for path in sorted(folder.glob("*.txt"))]


def _read(path: Path) -> Bug:
    header, code = path.read_text(encoding="utf-8").split("\n\n", 1)
    fields = dict(line.split(": ", 1) for line in header.splitlines())
    return Bug(path.stem, fields, code, is_layer=path.parent == LAYERS)
