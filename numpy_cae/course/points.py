"""How many points each property of an exercise has."""

from collections.abc import Sequence

from numpy_cae.verify.operations.property import GRADIENT, REST, VALUE, Property

SHARE_OF_GROUP = {VALUE: 0.4, GRADIENT: 0.4, REST: 0.2}
"""The parts of an exercise's points for its value, its gradients and the rest. If an exercise has
no gradients or no rest, the value has their part, too."""


def share_points(properties: Sequence[Property], total: int) -> list[float]:
    """The points of each property of an exercise.

    Properties of one group have equal points, except that "value" has as many as all others of its
    group together.
    """
    groups = [tested.group for tested in properties]
    shares = {group: SHARE_OF_GROUP[group] for group in sorted(set(groups))}
    shares[VALUE] += 1 - sum(shares.values())
    weights = [1] * len(properties)
    for place, tested in enumerate(properties):
        if tested.name == "value":
            weights[place] = max(1, groups.count(VALUE) - 1)
    weight_of_group = dict.fromkeys(shares, 0)
    for weight, group in zip(weights, groups, strict=True):
        weight_of_group[group] += weight
    return [
        total * shares[group] * weight / weight_of_group[group]
        for weight, group in zip(weights, groups, strict=True)
    ]
