"""Labels come from file names and tables, and the split from the names of files."""

from data_synth import plan_takes, write_series
from studies.shared.material import labels_of, read_material


def test_synthetic_labels_come_from_the_table(tmp_path):
    plans = plan_takes(0.7, seed=3, kinds=["walk", "idle"])
    write_series(plans, tmp_path / "synthetic", rate=30.0)
    last = f"{plans[-1].name}.bvh"
    material = read_material([tmp_path / "synthetic"], [last])
    assert [take.path.name for take in material.testing] == [last]
    assert len(material.training) == len(plans) - 1
    kinds = {plan.name: plan.kind for plan in plans}
    for take in material.training + material.testing:
        assert (take.source, take.content) == ("synthetic", kinds[take.path.stem])
    assert len(material.of("bandai").training) == 0


def test_bandai_labels_come_from_the_name(tmp_path):
    path = tmp_path / "dataset-2_raise-up-left-hand_elderly_004.bvh"
    assert labels_of(path) == ("bandai", "raise-up-left-hand", "elderly")
    assert labels_of(tmp_path / "02_01.amc") == ("other", "", "")
