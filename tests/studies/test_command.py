"""The command `python -m studies` on a folder of synthetic takes and a tiny network."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from numpy_cae.evaluation import tables
from studies import claims
from studies.__main__ import NAMES, main, parse
from studies.jang2018 import behaviours, samples, training
from studies.shared.options import Inputs
from studies.shared.result import VERDICTS

TINY = "--test *_3.bvh --hidden 6 --latent 3 --epochs 1 --steps 2 --batch 4 --frames 20".split()


@pytest.fixture(scope="module")
def folder(labelled):
    return labelled.training[0].path.parent


@pytest.fixture(scope="module")
def model(small_manifold, tmp_path_factory):
    """Files of a model that records which takes it was not trained on, and of one that does not."""
    folder = tmp_path_factory.mktemp("model")
    settings = small_manifold.settings
    for name, test in (("known", ["*_3.bvh"]), ("silent", [])):
        recorded = replace(small_manifold, settings=settings | {"test": test})
        recorded.save(folder / f"{name}.npz")
    return folder


def run(*words):
    return main([str(word) for word in words])


def test_it_lists_the_studies(capsys):
    assert run() == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[2:]] == NAMES
    assert all(line.endswith(".") for line in lines[2:])
    assert run("spead") == 2
    assert (
        capsys.readouterr().err
        == "python -m studies spead: no study spead; `python -m studies` lists them\n"
    )


@pytest.mark.parametrize("name", ["report.md", "report.json"])
def test_files_of_the_users_are_not_replaced_and_nothing_is_measured(
    name, tmp_path, capsys, monkeypatch
):
    monkeypatch.setattr("studies.__main__.measure", None)
    (tmp_path / name).write_text("[1]")
    assert run("codes", "-o", tmp_path) == 2
    assert name in capsys.readouterr().err
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [(name, "[1]")]


def test_an_earlier_report_is_replaced_and_other_pictures_are_not(folder, model, tmp_path, capsys):
    words = ["codes", "--data", folder, "-m", model / "known.npz", "--test", "*_3.bvh", "-o"]
    first, second = tmp_path / "first", tmp_path / "second"
    assert run(*words, first) == 0
    (first / "report.md").write_text("old")
    assert run(*words, first) == 0
    assert (first / "report.md").read_text().startswith("#")
    second.mkdir()
    (second / "codes.png").write_text("mine")
    assert run(*words, second) == 2
    assert (second / "codes.png").read_text() == "mine"


def test_a_file_is_no_folder_for_a_report(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("studies.__main__.measure", None)
    (tmp_path / "file").touch()
    assert run("codes", "-o", tmp_path / "file") == 2
    assert "is a file, expected a folder" in capsys.readouterr().err


def test_a_map_of_one_take_is_refused(folder, capsys):
    name = sorted(folder.glob("*.bvh"))[0].name
    assert run("codes", "--data", folder, "--unseen", "--test", name) == 2
    assert "two takes or more" in capsys.readouterr().err


def test_it_writes_its_files_and_a_study_that_cannot_be_run_stops_no_other(
    folder, model, tmp_path, capsys
):
    out = tmp_path / "new"
    words = ["--data", folder, "-m", model / "known.npz", "-o", out]
    assert run("interpolation", "stepped_keys", *words) == 0
    captured = capsys.readouterr()
    assert "interpolation could not be run: the test takes have neither" in captured.err
    assert "claims confirmed\n" in captured.out
    report, data = ((out / f"report.{suffix}").read_text() for suffix in ("md", "json"))
    assert report.startswith("# ") and report.count("\n# ") == 1
    assert "](stepped_keys.png)" in report and (out / "stepped_keys.png").is_file()
    assert "the network" in report and "*_3.bvh" in report and f"NumPy {np.__version__}" in report
    results = json.loads(data)
    assert set(results) == {"interpolation", "stepped_keys"}
    made = results["stepped_keys"]["provenance"]
    assert made["data"].endswith("10 takes to fit baselines to, 5 to test")
    assert {"seed", "model", "training", "versions", "time"} < set(made)
    assert len(list(out.iterdir())) == 4
    assert run("interpolation", *words) == 2  # nothing could be run


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["-m", "silent.npz"], "names no test takes: give --test"),
        (["-m", "known.npz", "--test", "*_2.bvh"], "may be ones that it has seen"),
        (["-m", "silent.npz", "--test", "no_such*"], "holds no take to test"),
    ],
)
def test_takes_of_the_training_are_refused(
    folder, model, tmp_path, capsys, monkeypatch, words, message
):
    monkeypatch.chdir(model)
    assert run("stepped_keys", "--data", folder, "-o", tmp_path / "out", *words) == 2
    assert message in capsys.readouterr().err.splitlines()[-1]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("words", "path"), [([], None), (["--network", "x.npz"], Path("x.npz"))])
def test_the_option_network_of_claims_is_a_file(words, path):
    inputs = Inputs(parse({"claims": claims}, words))
    assert inputs.of(claims.run)["network"] == path


def test_the_study_of_sequences_has_claims_and_pictures(folder, tmp_path, capsys, monkeypatch):
    for module, name, fewer in (
        (tables, "PCA_CLIPS", 200),
        (samples, "SAMPLES", 20),
        (behaviours, "CLIPS", 2),
        (samples, "SHOWN_IN_PAPER", 2),
        (samples, "REPEATS", 1),
        (training, "CLIPS", 100),
        (samples, "CLIPS", 100),
    ):
        monkeypatch.setattr(module, name, fewer)
    out = tmp_path / "out"
    words = ["--data", folder, "-o", out, "--cache", tmp_path / "cache", *TINY]
    assert run("sequences", *words) == 0
    printed, report = capsys.readouterr(), (out / "report.md").read_text(encoding="utf-8")
    action = folder.name
    assert f"{action}, none, λ = 0\n" in printed.err and "sequences, epoch 1/1" in printed.err
    verdict = f"^({'|'.join(VERDICTS)}): .* Measured: "
    judged = len(re.findall(verdict, printed.out, re.MULTILINE))
    assert judged > 3 and judged == len(re.findall(verdict, report, re.MULTILINE))
    drawn = {f"{action}_fitted.{ending}" for ending in ("png", "html")}
    assert {"figure_2.png", *drawn} <= {path.name for path in out.iterdir()}
