"""The commands: what starting them imports, what they write, how they fail."""

import json
import re
import shutil
import subprocess
import sys
import time
from dataclasses import asdict, replace

import pytest

import numpy_cae
from data_synth import make_take
from numpy_cae.cli import SUBCOMMANDS, main
from numpy_cae.cli.commands import demo
from numpy_cae.cli.shared.output import working
from numpy_cae.manifold import load_manifold
from numpy_cae.mocap import write_bvh
from numpy_cae.training import Schedule, Stage, recipe


def run_python(*words):
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, check=True)


def test_help_lists_every_subcommand_and_imports_none():
    code = (
        "import sys\nfrom numpy_cae.cli import main\n"
        "try: main(['--help'])\nexcept SystemExit: print(*sys.modules)"
    )
    printed = run_python("-c", code).stdout
    indented = {line.split()[0] for line in printed.splitlines() if line.startswith("  ")}
    assert set(SUBCOMMANDS) <= indented
    assert "Repair the damaged joints and frames" in printed
    heavy = {"numpy", "scipy", "torch", "data_synth", "numpy_cae.cli.commands.train"}
    assert not set(printed.split()) & heavy


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        ("repiar a.bvh", "repair"),
        ("repair a.bvh --smoth", "--smooth"),
        ("repair a.bvh --sensitivty=0.6", "--sensitivity"),
        ("--verison", "--version"),
    ],
)
def test_a_mistyped_word_is_answered_in_one_line_with_what_was_meant(words, meant, capsys):
    with pytest.raises(SystemExit) as exit_:
        main(words.split())
    (line,) = capsys.readouterr().err.splitlines()
    assert exit_.value.code == 2 and line.endswith(" --help`")
    assert f"; did you mean {meant}?;" in line


def test_without_a_word_the_overview_is_printed(capsys):
    assert main([]) == 0
    assert "Repair the damaged joints and frames" in capsys.readouterr().out


def test_what_is_like_no_word_is_not_guessed(capsys):
    with pytest.raises(SystemExit):
        main(["xyz"])
    assert "did you mean" not in capsys.readouterr().err


@pytest.mark.skipif(not shutil.which("bash"), reason="completes in bash")
def test_a_shell_completes_subcommands_and_options(tmp_path):
    pytest.importorskip("shtab", reason="needs the extra `completion`")
    script = tmp_path / "numpy-cae.sh"
    script.write_text(run_python("-m", "numpy_cae", "--completion", "bash").stdout)
    for line, completed in (("numpy-cae rep", "repair"), ("numpy-cae repair --smo", "--smooth")):
        words = line.split()
        code = (
            f"source {script}; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; "
            "_shtab_numpy_cae numpy-cae; echo ${COMPREPLY[@]}"
        )
        shell = subprocess.run(["bash", "-c", code], capture_output=True, text=True, check=True)
        assert completed in shell.stdout.split()


def test_a_reader_that_ends_early_is_no_error(walks):
    command = [sys.executable, "-m", "numpy_cae", "rig", walks / "walk_0.bvh"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()
        assert process.stderr.read() == b"" and process.wait() == 1


def test_work_on_a_long_file_says_how_much_time_is_left(capsys, monkeypatch):
    monkeypatch.setattr("numpy_cae.progress.FIRST_SECONDS", 0.0)
    printed = ""
    with working("take.bvh") as is_done:
        time.sleep(0.1)
        is_done(0.001)  # some 100 s in all
        while "to go" not in printed:
            time.sleep(0.05)
            printed += capsys.readouterr().err
    assert re.search(r"^take\.bvh: \d+ s, about \d+ s to go\n", printed, re.MULTILINE)


def test_it_runs_as_a_module_and_prints_its_version():
    assert run_python("-m", "numpy_cae", "--version").stdout.split()[1] == numpy_cae.__version__


def test_train_measures_on_the_test_takes(walks, tmp_path, capsys, train, few_windows):
    other = tmp_path / "other"
    shutil.copytree(walks, other, ignore=shutil.ignore_patterns("walk_3.bvh"))
    options = ["--test", "*_3.bvh", "*_2.bvh", "--batch", 4, "--recipe", "fast"]
    file = train([walks, other], tmp_path / "m.npz", *options)
    captured = capsys.readouterr()
    assert "4 takes to train on (0.2 min, less than 10 is little" in captured.err
    assert "| the network " in captured.out
    manifold = load_manifold(file)
    assert manifold.rescales and manifold.settings["takes"] == 4
    assert manifold.settings["test"] == ["*_3.bvh", "*_2.bvh"]
    assert manifold.settings["folders"] == [
        {"name": walks.name, "files": 4, "test": 2},
        {"name": "other", "files": 3, "test": 1},
    ]
    stage = replace(recipe("fast").fine_tuning, epochs=2, rate=0.05, batch=4)
    expected = json.loads(json.dumps(asdict(stage)))
    assert manifold.settings["schedule"]["fine_tuning"] == expected


FAST = replace(recipe("fast").fine_tuning, epochs=9, rate=0.01)
FINE = recipe("paper").fine_tuning


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ("", Schedule()),
        ("--epochs 3 --rate 0.2", Schedule(Stage(epochs=3, rate=0.2), replace(FINE, epochs=3))),
        ("--recipe fast --epochs 9 --rate 0.01", replace(recipe("fast"), fine_tuning=FAST)),
    ],
)
def test_options_change_the_recipe(monkeypatch, options, expected):
    from numpy_cae.cli.commands import train

    seen = []
    monkeypatch.setattr(train, "run", lambda args: seen.append(args) or 0)
    assert main(["train", "folder", "-o", "m.npz", *options.split()]) == 0
    assert train.schedule_of(seen[0]) == expected


@pytest.mark.parametrize("engine", ["ops", "fast"])
def test_both_engines_and_every_recipe_train(walks, tmp_path, train, engine):
    recipe = {"ops": "fast", "fast": "best"}[engine]
    out = train(walks, tmp_path / "m.npz", "--engine", engine, "--recipe", recipe)
    assert load_manifold(out).rescales


def test_show_draws_a_strip_or_a_page(walks, tmp_path, run):
    faster = tmp_path / "faster.bvh"
    write_bvh(make_take("walk", 0, seconds=1.0, rate=60.0).motion, faster)
    for out in (tmp_path / "new", tmp_path / "new" / "both.html"):
        run("show", walks / "walk_1.bvh", faster, "-o", out)
    names = sorted(path.name for path in (tmp_path / "new").iterdir())
    assert names == ["both.html", "faster.png", "walk_1.png"]


def test_the_demo_writes_all_its_files(tmp_path, capsys, monkeypatch, run, few_windows):
    monkeypatch.setattr(demo, "TAKES", 2 * len(demo.KINDS))
    monkeypatch.setattr(demo, "TEST_EVERY", 2)
    monkeypatch.setattr(demo, "SECONDS", 1.5)
    stages = Schedule(layer=Stage(epochs=0), fine_tuning=Stage(epochs=1, rate=0.05, rescaled=True))
    monkeypatch.setattr(demo, "SCHEDULE", stages)
    run("demo", "-o", tmp_path / "demo", "--quiet")
    out = capsys.readouterr().out
    before, after = map(float, re.search(r"by ([\d.]+) cm .* are ([\d.]+) cm off", out).groups())
    assert after < 0.5 * before
    for method in ("as damaged", "PCA on windows, input / (1 - p)", "the network"):
        assert f"| {method} " in out
    motions = {"damaged.bvh", "repaired.bvh", "true.bvh"}
    expected = {"model.npz", "figure_1.png", "index.html", *motions}
    assert {path.name for path in (tmp_path / "demo").iterdir()} == expected
