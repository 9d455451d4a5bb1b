"""Other conventions of an operation: right in their own way, but not what the contract says.

Each is a patch of an operation (`patch.py`), in the text file that has the operation's name; its
sentence tells what differs, and in parentheses stands the property, if any, that only the contract
has.
"""

from functools import cache
from itertools import combinations
from pathlib import Path

from numpy_cae.verify.patch import Patch, read_patches

PATCHES = read_patches(Path(__file__).parent)


@cache
def conventions_of(operation: str) -> tuple[Patch, ...]:
    """The documented conventions of an operation other than ours, those that differ least first.

    Those of `gru_step` can be combined; those of `gru` are those of its step, repeated.
    """
    if operation == "gru":
        steps = conventions_of("gru_step")
        return tuple(Patch(s.name, "gru", "", s.sentence, (), calls=(s,)) for s in steps)
    single = tuple(patch for patch in PATCHES if patch.operation == operation)
    together = len(single) if operation == "gru_step" else 1
    return tuple(
        _combined(chosen)
        for count in range(1, together + 1)
        for chosen in combinations(single, count)
    )


def _combined(patches: tuple[Patch, ...]) -> Patch:
    return Patch(
        "_and_".join(patch.name for patch in patches),
        patches[0].operation,
        patches[0].caught_by,
        "; ".join(patch.sentence for patch in patches),
        tuple(replacement for patch in patches for replacement in patch.replacements),
    )
