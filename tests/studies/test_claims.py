"""The table of statements, and the studies whose right answer is known."""

from studies import claims
from studies.comparison import EQUATION_4, RAW_EXTREMES
from studies.shared.result import STATEMENTS, Result


def test_both_networks_are_judged_in_the_order_of_the_statements(
    small, small_manifold, labelled, tmp_path, monkeypatch
):
    small_manifold.save(tmp_path / "model.npz")
    monkeypatch.setattr(claims, "STUDIES", ("kinect", "sampling"))
    monkeypatch.setattr(claims, "judge_sequences", lambda quick, seed: Result("", []))
    files = 2 * [tmp_path / "model.npz"]
    result = claims.run(labelled, 0, *files, quick=True)
    keys = [claim.key for claim in result.claims]
    assert keys == sorted(keys, key=list(STATEMENTS).index)
    assert keys.count("kinect_closer") == keys.count("uniform_prior") == 2
    assert keys.count("deep_justified") == 1 and len(result.tables[0].rows) == len(keys)


def test_what_a_delay_and_what_unpooling_must_do(result_of):
    _, shares, _ = result_of("comparison").tables
    assert shares.value(RAW_EXTREMES, "24 frames") < 0.02  # only the hips' velocity changes
    assert shares.value(EQUATION_4, "24 frames") < 0.2
    _, table, _ = result_of("representation").tables
    assert table.value("truth", "error, cm") == 0
    assert table.value("random unpooling", "of the truth's") > 1.5
