"""The functions of `import numpy_cae`, and how motions show themselves in a notebook."""

import ast
import json
import re
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
    assert f"<title>{take.name}, fixed.bvh</title>" in (tmp_path / "page.html").read_text()
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


def test_filling_nothing_says_what_to_name(take):
    with pytest.raises(ValueError, match="say what is missing: joints, frames or both"):
        numpy_cae.fill(numpy_cae.load(take))


def test_one_joint_needs_no_list(take):
    motion = numpy_cae.load(take)
    one = numpy_cae.fill(motion, "left_wrist", (20, 40))
    several = numpy_cae.fill(motion, ["left_wrist"], (20, 40))
    np.testing.assert_array_equal(one.motion.rotations, several.motion.rotations)
    assert one.touched.any(axis=0).sum() == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"joints": "left_wirst"}, "joints: .*left_wirst"),
        ({"joints": []}, "joints is empty, expected names such as"),
        (
            {"joints": ["left_wrist", 7]},
            "joints has a value of type int, expected a string",
        ),
        ({"frames": 7}, r"frames is 7, expected \(first, last\), counted from 0"),
        (
            {"frames": (3, 4), "manifold": 7},
            "manifold is of type int, expected a MotionManifold",
        ),
    ],
)
def test_filling_names_the_argument_that_is_wrong(take, arguments, message):
    with pytest.raises((TypeError, ValueError), match=message):
        numpy_cae.fill(take, **arguments)


def test_a_path_stands_for_the_motion_in_the_file(take, tmp_path):
    repaired = numpy_cae.repair(take)
    by_motion = numpy_cae.repair(numpy_cae.load(take))
    np.testing.assert_array_equal(repaired.motion.rotations, by_motion.motion.rotations)
    filled = numpy_cae.fill(str(take), "left_wrist", (20, 40))
    assert filled.touched.any(axis=0).sum() == 1
    numpy_cae.save(take, tmp_path / "copy.bvh")
    assert (tmp_path / "copy.bvh").read_bytes() == take.read_bytes()
    numpy_cae.show(take, tmp_path / "copy.bvh", path=tmp_path / "page.html")
    assert "<title>take.bvh, copy.bvh" in (tmp_path / "page.html").read_text()


@pytest.mark.parametrize("name", ["repair", "fill", "project", "show"])
def test_what_is_no_motion_is_named(name):
    with pytest.raises(TypeError, match="is of type int, expected a Motion or the path of"):
        getattr(numpy_cae, name)(7)


def test_a_motion_made_in_memory_says_how_it_is_saved():
    motion = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    with pytest.raises(ValueError, match=r"fixed.bvh: .*numpy_cae\.save\(motion, path\)"):
        motion.save("fixed.bvh")


def test_projecting_takes_the_starter_or_the_path_of_a_model(take, tmp_path):
    motion = numpy_cae.load(take)
    starter = numpy_cae.manifold.starter()
    starter.save(tmp_path / "model.npz")
    expected = numpy_cae.project(motion, starter).rotations
    np.testing.assert_array_equal(numpy_cae.project(motion).rotations, expected)
    by_path = numpy_cae.project(take, tmp_path / "model.npz")
    np.testing.assert_array_equal(by_path.rotations, expected)


def test_a_sequential_manifold_is_refused_with_what_is_expected(take, tiny_manifolds):
    message = "manifold is a sequential one, expected a MotionManifold"
    with pytest.raises(ValueError, match=message):
        numpy_cae.repair(take, tiny_manifolds[0]["sequence"])


def test_findings_are_objects_or_entries_of_the_json_file_or_its_path(take, tmp_path):
    motion = numpy_cae.load(take)
    findings = numpy_cae.repair(motion).findings
    numpy_cae.cleanup.write_findings(tmp_path / "found.json", findings)
    entries = [finding.to_json() for finding in findings]
    expected = numpy_cae.repair(motion, findings=findings).motion.rotations
    for form in (entries, tmp_path / "found.json", str(tmp_path / "found.json"), tuple(findings)):
        repaired = numpy_cae.repair(motion, findings=form)
        np.testing.assert_array_equal(repaired.motion.rotations, expected)


def test_a_single_entry_marks_a_joint_or_a_limb(take):
    motion = numpy_cae.load(take)
    marked = numpy_cae.repair(motion, findings={"limb": "left_arm", "frames": [58, 68]})
    assert {finding.joint for finding in marked.findings} == {"left_elbow", "left_wrist"}


@pytest.mark.parametrize(
    ("findings", "message"),
    [
        ([{"joint": "left_wirst"}], "findings, entry 1: .*left_wirst"),
        ([7], "findings, entry 1: expected one such as in"),
        (7, "findings is of type int, expected Finding objects, a list such as"),
        ("no.json", "no.json"),
    ],
)
def test_findings_that_do_not_fit_are_named(take, findings, message):
    with pytest.raises((TypeError, ValueError), match=message):
        numpy_cae.repair(take, findings=findings)


def test_findings_are_shown_from_the_json_file(take, tmp_path):
    repaired = numpy_cae.repair(take)
    numpy_cae.cleanup.write_findings(tmp_path / "found.json", repaired.findings)
    page = tmp_path / "page.html"
    numpy_cae.show(take, repaired.motion, findings=tmp_path / "found.json", path=page)
    assert "<title>before, after" in page.read_text() and '"kind": "' in page.read_text()


def packed_motions(page):
    """The motions of a page, as they are packed in it."""
    text = page.read_text("utf-8")
    return json.loads(re.search(r"viewer-data[^>]*>(.*?)</script>", text)[1])["motions"]


def test_only_versions_of_one_file_are_coloured_by_distance(take, tmp_path):
    """Not two motions that have as many frames by chance."""
    page = tmp_path / "page.html"
    paths = [tmp_path / name for name in ("one.bvh", "other.bvh")]
    for path in paths:
        numpy_cae.save(take, path)
    numpy_cae.show(*paths, path=page)
    assert [(shown["label"], "moved" in shown) for shown in packed_motions(page)] == [
        ("one.bvh", False),
        ("other.bvh", False),
    ]
    motion = numpy_cae.load(paths[0])
    numpy_cae.show(motion, numpy_cae.repair(motion).motion, path=page)
    assert [(shown["label"], "moved" in shown) for shown in packed_motions(page)] == [
        ("before", False),
        ("after", True),
    ]


def test_showing_nothing_or_findings_of_one_motion_says_what_is_expected(take):
    with pytest.raises(ValueError, match="motions: there is none to show, expected at least one"):
        numpy_cae.show()
    with pytest.raises(ValueError, match="the number of motions is 1, expected two"):
        numpy_cae.show(take, findings={"joint": "left_wrist"}, path="page.html")
    with pytest.raises(ValueError, match="there are 2 labels for 1 motions"):
        numpy_cae.show(take, labels=["a", "b"], path="page.html")


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


def test_learning_takes_the_options_of_the_command_by_name(take, tmp_path, run):
    takes = tmp_path / "takes"
    takes.mkdir()
    for name in ("one.bvh", "other_5.bvh"):
        (takes / name).write_bytes(take.read_bytes())
    sizes = {"epochs": 1, "batch": 2, "window": 32, "rate": 0.001, "seed": 3}
    manifold = numpy_cae.learn(
        takes, "fast", test="*_5.bvh", engine="ops", quiet=True, filters=(4, 6), **sizes
    )
    options = [word for name, value in sizes.items() for word in (f"--{name}", value)]
    model = tmp_path / "model.npz"
    run(
        *("train", takes, "-o", model, "--recipe", "fast", "--test", "*_5.bvh"),
        *("--engine", "ops", "--quiet", "--filters", 4, 6, *options),
    )
    by_command = load_manifold(model)
    for layer, expected in zip(manifold.network.layers, by_command.network.layers, strict=True):
        np.testing.assert_array_equal(layer.w, expected.w)
    assert manifold.settings["losses"] == by_command.settings["losses"]
    assert manifold.settings["test"] == ["*_5.bvh"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"epochs": 0}, "epochs is 0, expected a whole number of at least 1"),
        ({"batch": 1.5}, "batch is 1.5, expected a whole number of at least 1"),
        ({"rate": -1}, "rate is -1, expected a finite number of 0 or more"),
        ({"filters": (4, 0)}, "filters is 0, expected a whole number of at least 1"),
        ({"window": 30}, "window is 30, expected a multiple of 8"),
        ({"test": "*.amc"}, r"no file that was read matches '\*.amc', none is left to test on"),
        ({"engine": "gpu"}, "engine"),
        ({"seed": -1}, "seed is -1, expected a whole number of at least 0"),
    ],
)
def test_learning_names_the_argument_that_is_wrong(take, arguments, message):
    with pytest.raises((TypeError, ValueError), match=message):
        numpy_cae.learn(take.parent, quiet=True, **arguments)


def test_learning_needs_a_folder(tmp_path):
    with pytest.raises(TypeError, match="folders has a value of type int, expected a path"):
        numpy_cae.learn(7)
    with pytest.raises(ValueError, match="there is no such folder"):
        numpy_cae.learn([tmp_path / "none"])


def test_motions_show_themselves_in_a_notebook(take, monkeypatch):
    shell = pytest.importorskip("IPython.core.interactiveshell").InteractiveShell()
    monkeypatch.setattr("numpy_cae.viz.viewer.running_shell", lambda: shell)
    monkeypatch.setattr("numpy_cae.public.running_shell", lambda: shell)
    notebook.register()
    motion = numpy_cae.load(take)
    repaired = numpy_cae.repair(motion)
    for shown in (motion, numpy_cae.show(motion, repaired.motion), repaired):
        data, _ = shell.display_formatter.format(shown)
        assert data["text/html"].count("<iframe") == 1
    assert data["text/html"].startswith("<pre>left_wrist: frames")
    assert "before, after" in data["text/html"] and "confidence" in data["text/html"]
    assert data["text/plain"] == str(repaired)


def test_a_page_does_not_replace_the_motion_that_it_shows(tmp_path):
    path = tmp_path / "walk.bvh"
    numpy_cae.save(make_take("walk", 0, seconds=1.0, rate=30.0).motion, path)
    before = path.read_bytes()
    with pytest.raises(ValueError, match="is a motion to show"):
        numpy_cae.show(path, path=path)
    assert path.read_bytes() == before
