"""Every property of every operation: no alarm on what is right, however it is written."""

import pytest
from hypothesis import settings
from written_otherwise import CONVENTIONS, RIGHT, gru_in

from numpy_cae.verify.catalogue import CATALOGUE, properties_of
from numpy_cae.verify.convention import Convention, gru_step_in
from numpy_cae.verify.trial import try_property

ORDER = ("update", "reset", "new")
EACH_DIFFERENCE = (
    Convention(reset_after=False),
    Convention(update_keeps=False),
    Convention(order=ORDER),
)
ALL_DIFFERENCES = Convention(reset_after=False, update_keeps=False, order=ORDER)


def require_held(tried, implementation):
    outcome = try_property(tried, implementation, settings.default.max_examples // 2)
    assert outcome.held, f"{outcome.problem}\n{outcome.counterexample}\n{outcome.mistake}"


def test_properties_are_data():
    for name, task in CATALOGUE.items():
        listed = task.properties
        assert len({tried.name for tried in listed}) == len(listed) >= 8
        assert all(tried.operation == name and tried.statement for tried in listed)


@pytest.mark.parametrize(
    ("tried", "implementation"),
    [
        pytest.param(tried, function, id=f"{function.__name__}: {tried.name}")
        for name, function in RIGHT
        for tried in CATALOGUE[name].properties
    ],
)
def test_what_is_written_otherwise_holds(tried, implementation):
    require_held(tried, implementation)


@pytest.mark.parametrize("convention", [*EACH_DIFFERENCE, ALL_DIFFERENCES], ids=str)
def test_other_conventions_hold_by_their_own_definitions(convention):
    for tried in properties_of("gru_step", convention):
        require_held(tried, gru_step_in(convention))
    for tried in properties_of("gru", convention) if convention == ALL_DIFFERENCES else ():
        require_held(tried, gru_in(convention))


@pytest.mark.parametrize("convention", CONVENTIONS, ids=str)
def test_other_conventions_have_other_values(convention):
    value = CATALOGUE["gru_step"].properties[0]
    assert not try_property(value, gru_step_in(convention), 20, shrink=False).held
