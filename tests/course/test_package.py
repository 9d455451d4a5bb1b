"""Wheel and sdist in a fresh environment: the students' copies, and grading one of them."""

import os
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest

from numpy_cae.course.notebooks import find_lessons

ROOT = Path(__file__).parents[2]
LESSONS = find_lessons(ROOT / "lessons")
pytest.importorskip("setuptools", "64")


def run(*words: str | Path, code: int = 0, **options) -> str:
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        list(map(str, words)), capture_output=True, text=True, env=clean, **options
    )
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> tuple[Path, Path]:
    """The sdist, and the wheel that is built of it."""
    folder = tmp_path_factory.mktemp("built")
    files = run("git", "ls-files", cwd=ROOT).splitlines()
    for file in filter(lambda file: (ROOT / file).is_file(), files):
        (folder / "clone" / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / "clone" / file).write_bytes((ROOT / file).read_bytes())
    build = "from setuptools import build_meta; print(build_meta.build_sdist('..'))"
    run(sys.executable, "-c", build, cwd=folder / "clone")
    (sdist,) = folder.glob("*.tar.gz")
    run(sys.executable, "-m", "pip", "wheel", "--no-deps", "--quiet", "-w", folder, sdist)
    (wheel,) = folder.glob("*.whl")
    return sdist, wheel


@pytest.mark.lessons
def test_the_sdist_has_the_lessons_tests_and_docs(built):
    with tarfile.open(built[0]) as packed:
        names = {name.partition("/")[2] for name in packed.getnames()}
    assert {f"lessons/{path.name}" for path in LESSONS} < names
    assert {
        "tests/conftest.py",
        "docs/map.md",
        "README.md",
        "LICENSE",
        "setup.cfg",
        "setup.py",
    } < names
    assert not [name for name in names if "__pycache__" in name or name.endswith(".npz.tmp")]


@pytest.mark.lessons
def test_the_wheel_writes_students_copies_and_grades_them(built, tmp_path):
    with zipfile.ZipFile(built[1]) as packed:
        inside = [name for name in packed.namelist() if name.endswith(".ipynb")]
        assert not any(b"BEGIN SOLUTION" in packed.read(name) for name in inside)
        assert not any(name.startswith(("lessons/", "tests/")) for name in packed.namelist())
    assert len(inside) == len(list((ROOT / "lessons").glob("*.ipynb")))
    venv.create(tmp_path / "venv", with_pip=True)
    packages = next((tmp_path / "venv").glob("[lL]ib/**/site-packages"))
    ours = next(path for path in map(Path, sys.path) if (path / "numpy" / "__init__.py").is_file())
    (packages / "others.pth").write_text(str(ours))  # NumPy and the others, without an index
    scripts = tmp_path / "venv" / ("Scripts" if os.name == "nt" else "bin")
    offline = ("--no-deps", "--no-index", "--ignore-installed", "--quiet")
    run(scripts / "python", "-m", "pip", "install", *offline, built[1])
    command = next(scripts.glob("numpy-cae*"))
    run(command, "lessons", "student", cwd=tmp_path)
    run(command, "lessons", "--release", "week.zip", "03", cwd=tmp_path)
    copies = find_lessons(tmp_path / "student")
    assert [path.name for path in copies] == [path.name for path in LESSONS]
    assert "0 of 80 points, FAILED" in run(command, "verify", copies[3], code=1)
    assert "80 of 80 points, every property held" in run(command, "verify", LESSONS[3])
