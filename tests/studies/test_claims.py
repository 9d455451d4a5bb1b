"""The table of statements, and the studies whose right answer is known."""

from numpy_cae.training import Schedule, Stage
from studies import claims, comparison, paper_size, representation
from studies.comparison import EQUATION_4, RAW_EXTREMES
from studies.shared.result import STATEMENTS, Result


def test_both_networks_are_judged_in_the_order_of_the_statements(
    small_manifold, labelled, tmp_path, monkeypatch
):
    small_manifold.save(tmp_path / "model.npz")
    monkeypatch.setattr(claims, "STUDIES", (comparison, representation))
    monkeypatch.setattr(claims.depth, "FILTERS", (4, 6, 8))
    slow = Schedule(layer=Stage(rate=0.02))
    monkeypatch.setattr(claims.depth, "recipe", lambda name: slow)
    monkeypatch.setattr(claims, "_jang2018", lambda quick, seed: Result("", []))
    files = 2 * [tmp_path / "model.npz"]
    result = claims.run(labelled, 0, *files, quick=True)
    keys = [claim.key for claim in result.claims]
    assert keys == sorted(keys, key=list(STATEMENTS).index)
    assert keys.count("G_invariant") == keys.count("random_noisy") == 2
    assert keys.count("deep_justified") == 1 and len(result.tables[0].rows) == len(keys)


def test_what_a_delay_and_what_unpooling_must_do(result_of):
    _, shares, _ = result_of("comparison").tables
    assert shares.value(RAW_EXTREMES, "24 frames") < 0.02  # only the hips' velocity changes
    assert shares.value(EQUATION_4, "24 frames") < 0.2
    _, table, _ = result_of("representation").tables
    assert table.value("truth", "error, cm") == 0
    assert table.value("random unpooling", "of the truth's") > 1.5


def test_the_plans_of_a_size_make_so_many_windows(tmp_path, monkeypatch):
    plans = paper_size.plan_cmu_scale(0)
    assert len(paper_size._first(plans, 9673)) == len(plans) == 2605
    monkeypatch.setattr(paper_size, "TEST_MINUTES", 0.1)
    quick = Schedule(*2 * [Stage(epochs=1, rate=0.01)])
    monkeypatch.setattr(paper_size, "Schedule", lambda: quick)
    errors, times = paper_size.run((2, 4), models=tmp_path).tables
    again, _ = paper_size.run((2, 4), models=tmp_path).tables
    assert errors.rows == again.rows and [row[0] for row in times.rows][-1] == "fine tuning"
