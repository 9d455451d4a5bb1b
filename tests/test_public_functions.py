"""The functions of `import numpy_cae`, and how motions show themselves in a notebook."""

import ast
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import numpy_cae
from data_synth import make_take
from numpy_cae import notebook
from numpy_cae.manifold import load_manifold
from numpy_cae.mocap import load_motion, write_bvh

HEAVY = ("scipy", "matplotlib", "numpy_cae.manifold", "numpy_cae.mocap", "numpy_cae.motion")


@pytest.fixture(scope="module")
def take(tmp_path_factory):
    path = tmp_path_factory.mktemp("takes") / "take.bvh"
    motion = make_take("walk", 0, seconds=2.0, rate=60.0).motion
    motion.translations[60:66, motion.skeleton.index("lwrist")] += 0.5
    write_bvh(motion, path, unit=0.01)
    return path


def test_importing_loads_nothing_heavy_and_names_are_loaded_when_used():
    code = f"import sys, numpy_cae; print([m for m in {HEAVY} if m in sys.modules])"
    code += "; numpy_cae.repair; print(numpy_cae.verify.properties)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("[]\n<")
    names = {"load", "repair", "ops", "verify"}
    assert names <= {*dir(numpy_cae)} and "errors" not in dir(numpy_cae)
    with pytest.raises(AttributeError, match="numpy_cae has no 'repiar'"):
        _ = numpy_cae.repiar


def test_a_motion_is_loaded_repaired_shown_and_saved_as_it_came_in(take, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    motion = numpy_cae.load(take)
    repaired = numpy_cae.repair(motion)
    assert str(repaired).startswith("left_wrist: frames 60 to 65: moved ")
    repaired.motion.save(tmp_path / "fixed.bvh")
    before, after = (path.read_text().splitlines() for path in (take, tmp_path / "fixed.bvh"))
    differ = sum(one != other for one, other in zip(before, after, strict=True))
    assert differ == repaired.touched.any(axis=1).sum()
    fixed = numpy_cae.load(tmp_path / "fixed.bvh")
    np.testing.assert_allclose(fixed.positions(), repaired.motion.positions(), atol=1e-4)
    repaired.motion.resampled(30).save(tmp_path / "slower.bvh")
    assert load_motion(tmp_path / "slower.bvh").rate == 30

    assert numpy_cae.show(motion, fixed, path=tmp_path / "page.html") is None
    assert "motion 2" in (tmp_path / "page.html").read_text()
    numpy_cae.show(motion, fixed, labels=["a", "b"], findings=repaired.findings, path="l.html")
    assert "<title>a, b" in Path("l.html").read_text()
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    numpy_cae.show(motion)
    assert opened[0].startswith("file://") and opened[0].endswith(".html")


def test_motions_and_what_is_learned_are_compared_by_identity(take):
    motion = numpy_cae.load(take)
    again = numpy_cae.load(take)
    assert motion == motion and motion != again
    assert again in [motion, again] and again not in [motion]
    assert len({motion, again, motion}) == 2
    assert motion.skeleton != again.skeleton
    assert numpy_cae.manifold.starter() != numpy_cae.manifold.starter()
    filled = numpy_cae.fill(motion, joints=["left_wrist"], frames=(3, 9))
    assert filled == filled and hash(filled) == hash(filled)


def dataclasses_with_arrays() -> list[tuple[str, str]]:
    """The name and the decorator of each dataclass that has a field for an array."""
    root = Path(numpy_cae.__file__).parents[1]
    paths = [*(root / "numpy_cae").rglob("*.py"), *(root / "data_synth").rglob("*.py")]
    trees = [ast.parse(path.read_text(encoding="utf-8")) for path in paths]
    decorated = []
    for node in (node for tree in trees for node in ast.walk(tree)):
        if isinstance(node, ast.ClassDef):
            fields = [field for field in node.body if isinstance(field, ast.AnnAssign)]
            if any("ndarray" in ast.unparse(field.annotation) for field in fields):
                decorators = [ast.unparse(decorator) for decorator in node.decorator_list]
                decorated += [(node.name, text) for text in decorators if "dataclass" in text]
    return decorated


@pytest.mark.parametrize(("name", "decorator"), dataclasses_with_arrays())
def test_a_dataclass_with_arrays_is_compared_by_identity(name, decorator):
    assert "eq=False" in decorator


def test_filling_takes_joints_and_frames(take):
    motion = numpy_cae.load(take)
    filled = numpy_cae.fill(motion, joints=["left_wrist", "rradius"], frames=(20, 40))
    assert np.argwhere(filled.touched).min(axis=0).tolist() == [20, 7]
    assert filled.touched[20:41].all(axis=0).sum() == filled.touched.any(axis=0).sum() == 2
    assert numpy_cae.fill(motion.at(slice(9)), frames=(3, 4)).touched.sum() == 40
    with pytest.raises(ValueError, match="frames 3 to 120, the motion has 0 to 119"):
        numpy_cae.fill(motion, frames=(3, 120))


def test_a_manifold_is_learned_saved_and_projects_motions(take, tmp_path, monkeypatch):
    from numpy_cae.training import RECIPES, Schedule, Stage

    monkeypatch.setitem(RECIPES, "fast", Schedule(Stage(epochs=0), Stage(epochs=1)))
    manifold = numpy_cae.learn(take.parent)
    assert repr(manifold) == "manifold of layers with 64, 128, 256 filters, learned from 1 take"
    motion = numpy_cae.load(take)
    projected = numpy_cae.project(motion, manifold)
    assert (len(projected), projected.rate) == (120, 60)
    manifold.save(tmp_path / "model.npz")
    again = numpy_cae.project(motion, load_manifold(tmp_path / "model.npz"))
    np.testing.assert_array_equal(again.rotations, projected.rotations)
    with pytest.raises(ValueError, match="no recipe 'slow', expected one of paper"):
        numpy_cae.learn(take.parent, "slow")


def test_motions_show_themselves_in_a_notebook(take, monkeypatch):
    shell = pytest.importorskip("IPython.core.interactiveshell").InteractiveShell()
    monkeypatch.setattr("numpy_cae.ipython.shell", lambda: shell)
    notebook.register()
    motion = numpy_cae.load(take)
    repaired = numpy_cae.repair(motion)
    for shown in (motion, numpy_cae.show(motion, repaired.motion), repaired):
        data, _ = shell.display_formatter.format(shown)
        assert data["text/html"].count("<iframe") == 1
    assert data["text/html"].startswith("<pre>left_wrist: frames")
    assert "before, after" in data["text/html"] and "confidence" in data["text/html"]
    assert data["text/plain"] == str(repaired)
