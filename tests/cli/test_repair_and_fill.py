"""`numpy-cae repair` and `numpy-cae fill`: what is damaged or missing, folders, what is written."""

import json
import re
import shlex
import shutil
import sys
from dataclasses import replace

import numpy as np
import pytest
from acclaim_files import write_acclaim

from data_synth import make_take
from numpy_cae.cli import main
from numpy_cae.mocap import load_motion, write_bvh
from numpy_cae.motion.quaternions import from_vector


@pytest.fixture(scope="module")
def take():
    return make_take("walk", 0, seconds=1.0, rate=120.0).motion


@pytest.fixture(scope="module")
def folder(take, untrained_manifold, tmp_path_factory):
    """A file in inches, the same person for Acclaim, and a model that learned nothing."""
    folder = tmp_path_factory.mktemp("fill")
    write_bvh(take, folder / "walk.bvh", unit=0.0254)
    write_acclaim(take, folder / "walk.amc")
    write_bvh(take.at(slice(0, 1)), folder / "one.bvh", unit=0.0254)
    untrained_manifold.save(folder / "model.npz")
    return folder


def fill(folder, file, output, *argv):
    return ["fill", folder / file, "-m", folder / "model.npz", "-o", output, *argv]


@pytest.mark.parametrize("file", ["walk.bvh", "walk.amc", "one.bvh"])
@pytest.mark.parametrize("what", [("--joint", "left_wrist"), ("--keyframes", 15)])
def test_the_rig_the_rate_and_the_unit_come_back(folder, tmp_path, file, what, capsys, run):
    run(*fill(folder, file, tmp_path / "filled.bvh", *what, "--html"))
    came, filled = load_motion(folder / file), load_motion(tmp_path / "filled.bvh")
    assert set(filled.skeleton.names) == set(came.skeleton.names)
    assert (filled.rate, len(filled)) == (came.rate, len(came))
    assert filled.unit == pytest.approx(came.unit)
    assert f"{len(came)} frames at 120 a second, 31 joints" in capsys.readouterr().out
    assert ", filled: " in (tmp_path / "filled.html").read_text(encoding="utf-8")


def changed_joints(before, after):
    """(frames, joints) whose rotations differ."""
    return np.any(before.rotations != after.rotations, axis=-1)


def test_only_the_text_of_what_is_missing_changes(folder, tmp_path, capsys, run):
    out = tmp_path / "f.bvh"
    run(*fill(folder, "walk.bvh", out, "--joint", "rradius", "--frames", 40, 80))
    assert "right_elbow: frames 40 to 80: " in capsys.readouterr().out
    old, new = ((each).read_bytes().splitlines() for each in (folder / "walk.bvh", out))
    first = len(old) - 120
    lines = [number - first for number in range(len(old)) if old[number] != new[number]]
    assert lines and set(lines) <= set(range(40, 81))
    came, filled = load_motion(folder / "walk.bvh"), load_motion(out)
    names = np.array(came.skeleton.names)[changed_joints(came, filled).any(axis=0)]
    assert set(names) <= {"rhumerus", "rradius", "rwrist"}


def test_limbs_and_a_mask_file(folder, tmp_path, capsys, run):
    out = tmp_path / "m.bvh"
    run(*fill(folder, "walk.bvh", out, "--limb", "left_arm", "--frames", 3, 3))
    assert "left_elbow, left_wrist: frame 3: " in capsys.readouterr().out
    mask = tmp_path / "mask.json"
    mask.write_text('[{"joint": "left_wrist", "frames": [9, 9]}, {"frames": [5, 6]}]')
    run(*fill(folder, "walk.bvh", out, "--mask", mask))
    assert "left_wrist: frames 5 to 6, 9: " in capsys.readouterr().out


def test_a_limb_without_frames_is_said_to_be_replaced_in_all(folder, tmp_path, capsys, run):
    run(*fill(folder, "walk.bvh", tmp_path / "m.bvh", "--limb", "left_arm"))
    message = "replaced in all frames, since --frames is not given: left_arm"
    assert message in capsys.readouterr().out


def test_smoothing_is_advised_where_joints_turn_back_within_frames(takes, tmp_path, capsys):
    walk = load_motion(takes / "clean.bvh")
    elbow = walk.skeleton.index("lradius")
    frame = np.arange(len(walk))
    angle = 0.25 * np.abs((frame % 16) - 8.0)
    walk.rotations[:, elbow] = from_vector(angle[:, None] * [0.0, 0.0, 1.0])
    write_bvh(walk, tmp_path / "turns.bvh")
    for name, is_advised in ((tmp_path / "turns.bvh", True), (takes / "clean.bvh", False)):
        main(["repair", str(name), "-o", str(tmp_path / "out.bvh"), "--sensitivity", "0.1"])
        advice = "joints stop or start within a frame"
        assert (advice in capsys.readouterr().out) == is_advised


def test_the_input_is_overwritten_on_request_only(folder, tmp_path, error_of, run):
    copy = tmp_path / "walk.bvh"
    copy.write_bytes((folder / "walk.bvh").read_bytes())
    words = ["fill", copy, "-m", folder / "model.npz", "--joint", "left_wrist"]
    for output in (copy, tmp_path):
        assert "--overwrite allows this" in error_of(*words, "-o", output)
    (tmp_path / "b.bvh").write_text("of another")
    assert "exists and is no version of" in error_of(*words, "-o", tmp_path / "b.bvh")
    assert "-o, or use --dry-run" in error_of(*words)
    run(*words, "--dry-run")
    assert copy.read_bytes() == (folder / "walk.bvh").read_bytes()
    run(*words, "-o", copy, "--overwrite")
    assert copy.read_bytes() != (folder / "walk.bvh").read_bytes()


@pytest.mark.parametrize("command", ["fill --joint left_wrist", "repair --joint left_wrist"])
def test_another_motion_of_the_rig_is_not_replaced(command, take, folder, tmp_path, error_of, run):
    """Its hierarchy is longer than its motion, so that most lines of both files are the same."""
    name, *options = command.split()
    words = [name, folder / "walk.bvh", "-m", folder / "model.npz", *options]
    other = tmp_path / "other.bvh"
    moved = replace(take, translations=take.translations + 1).at(slice(0, 40))
    write_bvh(moved, other, unit=0.0254)
    before = other.read_bytes()
    assert "exists and has other contents" in error_of(*words, "-o", other)
    assert other.read_bytes() == before
    run(*words, "-o", other, "--overwrite")
    assert other.read_bytes() != before


def test_an_earlier_repair_is_replaced(folder, tmp_path, run):
    words = ["fill", folder / "walk.bvh", "-m", folder / "model.npz", "--joint", "left_wrist"]
    for frames in ((3, 9), (4, 12)):
        run(*words, "-o", tmp_path / "out.bvh", "--frames", *frames)


@pytest.fixture(scope="module")
def takes(tmp_path_factory):
    """A folder of two takes, one with a spike, and a file that is damaged beyond use."""
    takes = tmp_path_factory.mktemp("takes") / "in"
    (takes / "more").mkdir(parents=True)
    clean = make_take("walk", 3, seconds=3.0, rate=30.0).motion
    write_bvh(clean, takes / "clean.bvh", unit=0.01)
    rotations = clean.rotations.copy()
    rotations[40, clean.skeleton.index("lhumerus")] = (0.0, 0.0, 0.0, 1.0)
    rotations[40, clean.skeleton.index("lradius")] = (0.6, 0.0, 0.0, 0.8)
    write_bvh(replace(clean, rotations=rotations), takes / "more" / "spike.bvh", unit=0.01)
    return takes


def test_repair_of_a_folder_lists_what_could_not_be_used(takes, tmp_path, capsys, run):
    out = tmp_path / "out"
    run("repair", takes, "-o", out, "--html", "--findings", out / "found")
    assert "spike.bvh: 2 findings, 0.0 of 3.0 s changed" in capsys.readouterr().out
    assert {path.name for path in out.rglob("*.html")} == {"spike.html", "index.html"}
    assert 'href="more/spike.html">spike.bvh</a>' in (out / "index.html").read_text("utf-8")
    before, after = (load_motion(each / "more" / "spike.bvh") for each in (takes, out))
    assert changed_joints(before, after)[40, before.skeleton.index("lradius")]

    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "bad.bvh").write_text("HIERARCHY\n")
    words = ["repair", str(tmp_path / "in"), "--dry-run"]
    assert main(words) == 2
    assert "1 of 1 files could not be used" in capsys.readouterr().out
    (tmp_path / "in" / "good.bvh").write_bytes((takes / "clean.bvh").read_bytes())
    assert main(words) == 1
    assert "1 of 2 files could not be used" in capsys.readouterr().out


def test_what_the_model_does_not_know_stays_as_it_is(folder, tmp_path, capsys, monkeypatch, run):
    monkeypatch.setattr(sys.modules["numpy_cae.cleanup.repair"], "UNKNOWN_METRES", 0.0)
    out = tmp_path / "out.bvh"
    words = ["repair", folder / "walk.bvh", "-m", folder / "model.npz", "-o", out]
    assert main([*map(str, words)]) == 4
    assert "unlike what the model knows" in capsys.readouterr().out
    assert out.read_bytes() == (folder / "walk.bvh").read_bytes()
    marks = ["--joint", "left_wrist", "--frames", 3, 50]
    run(*words, *marks)
    assert out.read_bytes() != (folder / "walk.bvh").read_bytes()
    run(*words, "--project")
    assert "all joints: frames 0 to 119: " in capsys.readouterr().out


def test_findings_are_written_corrected_and_passed_back(takes, tmp_path, capsys, run):
    spiked, found, out = takes / "more" / "spike.bvh", tmp_path / "found.json", tmp_path / "out.bvh"
    assert main(["repair", str(spiked), "--dry-run", "--findings", str(found)]) == 0
    entries = json.loads(found.read_text("utf-8"))
    assert {entry["joint"] for entry in entries} == {"left_shoulder", "left_elbow"}
    assert all(entry["frames"] == [40, 40] and entry["cm"] > 5 for entry in entries)
    found.write_text(json.dumps([entries[0]]))
    run("repair", spiked, "-o", out, "--mask", found)
    before, after = load_motion(spiked), load_motion(out)
    assert changed_joints(before, after).sum() == 1
    run("fill", spiked, "-o", out, "--mask", found)
    found.write_text(json.dumps([entries[0] | {"kind": "odd"}]))
    assert main(["repair", str(spiked), "-o", str(out), "--mask", str(found)]) == 2
    assert "found.json: entry 1: kind is 'odd'" in capsys.readouterr().err


def test_the_command_of_a_finding_writes_what_the_page_shows(takes, tmp_path, run):
    """Its bytes are those of the whole repair in the frames of the finding, else of the file."""
    spiked = load_motion(takes / "more" / "spike.bvh")
    spiked.rotations[60:62, spiked.skeleton.index("rtibia")] = (0.6, 0.0, 0.0, 0.8)
    source, out = tmp_path / "two spikes.bvh", tmp_path / "out.bvh"
    write_bvh(spiked, source)
    run("repair", source, "-o", out, "--html", "--sensitivity", 0.6, "--from", "suit")
    page = re.search(
        r"viewer-data[^>]*>(.*?)</script>", out.with_suffix(".html").read_text("utf-8")
    )
    data = json.loads(page[1])
    assert f"<li>{len(data['findings'])} findings: " in out.with_suffix(".html").read_text("utf-8")
    assert "--sensitivity=0.6" in data["command"] and "--from=suit" in data["command"]
    numbers = [n for n, each in enumerate(data["findings"], 1) if each["joint"] == "right_knee"]
    assert numbers and len(numbers) < len(data["findings"])
    run(*shlex.split(data["command"])[1:], "--only", *numbers)
    files = (source, out, tmp_path / "out_finding_0.bvh")
    before, whole, part = (path.read_bytes().splitlines()[-90:] for path in files)
    assert before[60:62] != whole[60:62] and before[40] != whole[40]
    assert part == before[:60] + whole[60:62] + before[62:]


def test_only_what_is_repaired_or_accepted_is_applied(takes, tmp_path, capsys):
    """By our name of a joint or the rig's; a head moves no joint, and is changed too."""
    clean, found, out = takes / "clean.bvh", tmp_path / "found.json", tmp_path / "out.bvh"
    words = ["repair", str(clean), "-o", str(out), "--mask", str(found)]
    for joint in ("lradius", "left_elbow", "head"):
        proposed = {"joint": joint, "frames": [40, 42], "kind": "spike", "status": "proposed"}
        for entries, status in (([], 3), ([proposed], 3), ([proposed | {"accept": True}], 0)):
            found.write_text(json.dumps(entries))
            assert main(words) == status
            assert (out.read_bytes() == clean.read_bytes()) == (status == 3)
    for text, message in (
        ('[{"joint": "head", "joint": "hips", "frames": [3, 4]}]', "'joint' is twice"),
        ('[{"frames": [0, 9]}, {"joint": "lhand", "frames": [3, 4], "kind": "foot"}]', "entry 2"),
        ('[{"joint": "body", "frames": [0, 89], "kind": "T-pose"}]', "ends before the last frame"),
    ):
        found.write_text(text)
        assert main(words) == 2
        assert message in capsys.readouterr().err


def test_a_clean_file_comes_back_with_a_status_of_its_own_and_no_page(takes, tmp_path, capsys):
    out = tmp_path / "clean.bvh"
    words = ["repair", str(takes / "clean.bvh"), "-o", str(out), "--html", "--from", "optical"]
    assert main(words) == 3
    assert "--from optical: sensitivity 0.5" in capsys.readouterr().out
    assert out.read_bytes() == (takes / "clean.bvh").read_bytes()
    assert not out.with_suffix(".html").exists()


def test_the_page_of_a_folder_has_unusable_files_first_and_clean_ones_folded(takes, tmp_path):
    folder = tmp_path / "in"
    shutil.copytree(takes, folder)
    (folder / "bad.bvh").write_text("HIERARCHY\n")
    out = tmp_path / "out"
    assert main(["repair", str(folder), "-o", str(out), "--html"]) == 1
    page = (out / "index.html").read_text("utf-8")
    assert "<title>3 files: before and after</title>" in page
    places = [page.index(text) for text in ("bad.bvh", "<th scope=col>", "spike.bvh", "<details>")]
    assert places == sorted(places)
    assert page.index("<details>") < page.index("clean.bvh")


def test_a_pose_of_reference_that_stays_is_not_called_repaired(takes, tmp_path, capsys):
    """Nothing is written differently, so that there is no page either."""
    walk = load_motion(takes / "clean.bvh")
    walk.rotations[:30, 1:] = (1.0, 0.0, 0.0, 0.0)
    walk.translations[:30] = walk.translations[0]
    source, found, out = tmp_path / "posed.bvh", tmp_path / "found.json", tmp_path / "out.bvh"
    write_bvh(walk, source)
    words = ["repair", str(source), "-o", str(out), "--html", "--findings", str(found)]
    assert main(words) == 3
    (finding,) = json.loads(found.read_text("utf-8"))
    assert (finding["kind"], finding["status"]) == ("T-pose", "kept")
    assert "0 findings\n" in capsys.readouterr().out
    assert not out.with_suffix(".html").exists()


def test_a_number_repairs_a_proposal_too(takes, tmp_path, capsys, monkeypatch):
    """In a motion that the model does not know, what is frozen for long is proposed only."""
    monkeypatch.setattr("numpy_cae.cleanup.repair.UNKNOWN_METRES", 0.0)
    walk = load_motion(takes / "clean.bvh")
    for joint in ("lhumerus", "lradius"):
        column = walk.skeleton.index(joint)
        walk.rotations[20:66, column] = walk.rotations[20, column]
    source, out = tmp_path / "frozen.bvh", tmp_path / "out.bvh"
    write_bvh(walk, source)
    words = ["repair", str(source), "-o", str(out)]
    main(words)
    printed = capsys.readouterr().out
    number = int(re.search(r"proposed, not changed:\n(?:.*\n)*?\s+(\d+)\. left_", printed)[1])
    assert main([*words, "--overwrite", "--only", str(number)]) == 0
    before, after = load_motion(source), load_motion(out)
    assert changed_joints(before, after)[30:60].any()
    assert main([*words, "--overwrite", "--only", "99"]) == 2
    assert "--only 99: the repair has" in capsys.readouterr().err
