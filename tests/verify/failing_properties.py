"""Which properties an operation of one's own has not."""

from numpy_cae import verify
from numpy_cae.verify.operations.counterexample import failure


def failing(f, shapes, part=slice(None), **options):
    """The names of the properties that f has not, in all cases or in a part of them."""
    names = []
    for stated in verify.properties_of(f, shapes, **options):
        if any(failure(stated, f, case) for case in stated.cases()[part]):
            names.append(stated.name)
    return names
