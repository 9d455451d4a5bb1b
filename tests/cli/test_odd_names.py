"""Names that disturb: of files, joints and folders; output that is closed or strict."""

import csv
import io
import os
import shutil
import subprocess
import sys

import pytest
from acclaim_files import AMC, ASF, write_acclaim

from data_synth import make_take
from numpy_cae.cli import main
from numpy_cae.cli.shared.output import VisibleStream
from numpy_cae.mocap import load_motion, write_bvh
from numpy_cae.progress import ProgressLine

HOSTILE = "a\x1b[2J\u202e.bvh"
NOT_UTF8 = os.fsdecode(b"caf\xe9.bvh")
FORMULA = "=cmd|'|C calc'!A0.bvh"


@pytest.fixture(scope="module")
def model(untrained_manifold, tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "model.npz"
    untrained_manifold.save(path)
    return path


def command(*words, **options):
    """The command in a process of its own, as text."""
    words = [sys.executable, "-m", "numpy_cae", *map(str, words)]
    return subprocess.run(words, capture_output=True, text=True, check=False, **options)


def test_names_are_shown_escaped_in_messages_and_pages(walks, tmp_path, capsys, run):
    assert main(["rig", HOSTILE]) == 2
    shown = r"a\x1b[2J\u202e.bvh: there is no such file"
    assert shown in capsys.readouterr().err
    text = (walks / "walk_0.bvh").read_text().replace("head\n", "he\u202ead\n")
    (tmp_path / HOSTILE).write_text(text, encoding="utf-8")
    run("show", tmp_path / HOSTILE, "-o", tmp_path / "a.html")
    printed = capsys.readouterr()
    assert r"a\x1b[2J\u202e.bvh: " in printed.out and "\x1b" not in printed.out + printed.err
    page = next(tmp_path.glob("*.html")).read_text(encoding="utf-8")
    assert r"<title>a\x1b[2J\u202e.bvh" in page and r"he\\u202ead" in page
    assert "\u202e" not in page and "\x1b" not in page


def test_a_name_that_is_not_utf_8_is_printed_on_a_strict_output(walks, model, tmp_path):
    folder = tmp_path / os.fsdecode(b"\xe9")
    folder.mkdir()
    shutil.copy(walks / "walk_0.bvh", folder / NOT_UTF8)
    strict = os.environ | {"PYTHONIOENCODING": "utf-8:strict"}
    words = ("fill", folder, "-m", model, "-o", tmp_path / "out", "--joint", "left_wrist", "--html")
    done = command(*words, env=strict)
    assert done.returncode == 0, done.stderr
    assert r"caf\udce9.bvh: 3.0 of 3.0 s" in done.stdout
    page = next((tmp_path / "out").glob("caf*.html"))
    assert r"caf\udce9.bvh, filled: left wrist, frames 0 to 89" in page.read_text()


@pytest.mark.skipif(not os.path.exists("/bin/sh"), reason="closes its output by a shell")
def test_a_closed_output_is_no_error(walks):
    words = [sys.executable, "-m", "numpy_cae", "rig", str(walks / "walk_0.bvh")]
    closed = subprocess.run(["/bin/sh", "-c", 'exec "$@" >&-', "sh", *words], stderr=-1)
    assert (closed.returncode, closed.stderr) == (0, b"")


@pytest.mark.parametrize(
    ("no_color", "start"), [("", "\x1b[1mtake.bvh:\x1b[0m"), ("1", "take.bvh:")]
)
def test_a_terminal_gets_short_lines_in_its_encoding(monkeypatch, no_color, start):
    terminal = type(
        "Terminal", (io.StringIO,), {"encoding": "ascii", "isatty": lambda self: True}
    )()
    for name, value in {"COLUMNS": "24", "NO_COLOR": no_color, "TERM": "xterm"}.items():
        monkeypatch.setenv(name, value)
    print(
        "take.bvh: turned by 62° and back\n| a row of a table | is kept |",
        file=VisibleStream(terminal),
    )
    shown = f"{start} turned by\n    62\\xb0 and back\n| a row of a table | is kept |\n"
    assert terminal.getvalue() == shown


@pytest.fixture
def terminal(monkeypatch):
    """A terminal of 24 columns in colours."""
    for name, value in {"COLUMNS": "24", "NO_COLOR": "", "TERM": "xterm"}.items():
        monkeypatch.setenv(name, value)
    return type("Terminal", (io.StringIO,), {"encoding": "utf-8", "isatty": lambda self: True})()


def test_an_indent_that_is_written_before_a_line_counts_for_its_width(terminal):
    line = "a sentence of several words that is wrapped"
    print("take", line, line, sep="\n  ", file=VisibleStream(terminal))
    assert max(map(len, terminal.getvalue().splitlines())) <= 24


def test_errors_are_red_and_warnings_yellow(terminal):
    stream = VisibleStream(terminal)
    print("numpy-cae fill: bad", file=stream)
    print("slide: 3 → 4 (worse)", file=stream)
    assert terminal.getvalue() == (
        "\x1b[1;31mnumpy-cae fill:\x1b[0m bad\n\x1b[1mslide:\x1b[0m 3 → 4 \x1b[33m(worse)\x1b[0m\n"
    )


def test_progress_vanishes_before_anything_is_printed_and_at_the_end(terminal, monkeypatch):
    monkeypatch.setattr("numpy_cae.progress.FIRST_SECONDS", 0.0)
    monkeypatch.setattr("sys.stderr", VisibleStream(terminal))
    removed = "\r" + " " * 23 + "\r"
    with ProgressLine() as line:
        line.show("1 of 3 files")
        print("a note", file=sys.stderr)
        line.due = 0.0
        line.show("2 of 3 files")
    assert terminal.getvalue() == f"\r1 of 3 files{removed}a note\n\r2 of 3 files{removed}"


def test_no_cell_is_a_formula(walks, model, tmp_path, run):
    for name in (FORMULA, "walk.bvh"):
        shutil.copy(walks / "walk_0.bvh", tmp_path / name)
    run("compare", tmp_path, "-m", model, "-o", tmp_path / "g.csv")
    with (tmp_path / "g.csv").open(newline="", encoding="utf-8") as file:
        cells = [cell for row in csv.reader(file) for cell in row]
    assert not any(cell.startswith("=") for cell in cells)
    assert any(cell.startswith("'=") for cell in cells)


def test_two_inputs_are_not_written_to_one_file(walks, model, tmp_path, error_of):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        shutil.copy(walks / "walk_0.bvh", tmp_path / folder / "w.bvh")
    both, out = [tmp_path / "a" / "w.bvh", tmp_path / "b" / "w.bvh"], tmp_path / "pictures"
    assert "would both be written to" in error_of("show", *both, "-o", out)
    assert "would both be written to" in error_of("repair", *both, "-m", model, "-o", out)
    write_acclaim(make_take("walk", 0, seconds=1.0, rate=30.0).motion, tmp_path / "a" / "w.amc")
    words = "repair", tmp_path / "a", "-m", model, "-o", out, "--html"
    assert "w.html" in error_of(*words)
    assert not out.exists()


def test_a_motion_is_not_written_beside_another_skeleton(tmp_path):
    source, out = tmp_path / "in", tmp_path / "out"
    for folder in (source, out):
        folder.mkdir()
    (source / "02.asf").write_text(ASF)
    (source / "02_01.amc").write_text(AMC)
    motion = load_motion(source / "02_01.amc")
    for name, content in (("02.asf", ASF[:-9]), ("02_01.asf", ASF + "# another\n")):
        (out / name).write_text(content)
        with pytest.raises(ValueError, match="would be read with another skeleton"):
            motion.save(out / "02_01.amc")
        assert not (out / "02_01.amc").exists()
        (out / name).unlink()
    motion.save(out / "02_01.amc")
    assert (out / "02.asf").read_text() == ASF and len(load_motion(out / "02_01.amc")) == 3


def test_a_name_may_be_as_long_as_the_system_allows(tmp_path):
    path = tmp_path / f"{'é' * 125}.bvh"  # 254 bytes
    write_bvh(make_take("walk", 0, seconds=0.5, rate=30.0).motion, path)
    assert len(load_motion(path)) == 15
