"""The CMU database, from a server on this machine."""

import sys
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import pytest
from acclaim_files import write_amc, write_asf

from data_synth import make_take
from numpy_cae.download import DownloadError, cmu, download_cmu
from numpy_cae.mocap import find_motion_files, load_motion

pytest.importorskip("pooch", reason="needs the extra `download`")
PAGE = b"""<A HREF="subjects/07/07.asf">asf</A> <a href="subjects/07/07_01.amc">amc</a>
<A HREF="subjects/07/07_01.c3d">c3d</A> <a href="subjects/08/08_01.amc">of another subject</a>"""


class Handler(SimpleHTTPRequestHandler):
    """Answers with the files of a folder, whatever is asked after a question mark."""

    def log_message(self, *_):
        pass

    def copyfile(self, source, outputfile):
        """Send a file line by line, slowly where a line is a dot."""
        for line in source:
            outputfile.write(line)
            threading.Event().wait(0.05 * (line == b".\n"))


@pytest.fixture
def site(tmp_path, monkeypatch):
    """The folder and the address of a server."""
    folder = tmp_path / "site"
    (folder / "subjects" / "07").mkdir(parents=True)
    (folder / "search.php").write_bytes(PAGE)
    take = make_take("walk", 0, seconds=0.5, rate=120.0).motion
    write_asf(take.skeleton, folder / "subjects" / "07" / "07.asf")
    write_amc(take, folder / "subjects" / "07" / "07_01.amc")
    monkeypatch.setattr("time.sleep", lambda seconds: None)
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Handler, directory=folder)) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield folder, f"http://127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join()


def test_a_subject_and_its_checksums(site, tmp_path, capsys, run, error_of):
    folder, address = site
    words = ["download", "cmu", "--subjects", 7, "-o", tmp_path / "cmu", "--site", address]
    run(*words)
    printed = capsys.readouterr().out
    assert "NSF EIA-0196217" in printed and "2 files" in printed
    assert [len(load_motion(path)) for path in find_motion_files(tmp_path / "cmu")] == [60]
    take = tmp_path / "cmu" / "07" / "07_01.amc"
    (folder / "subjects" / "07" / "07_01.amc").write_bytes(b"1\nroot 0 0 0\n")
    run(*words, "--quiet")  # the files are there already, and are not downloaded again
    assert (tmp_path / "cmu" / "checksums.txt").read_text().count(".a") == 2
    take.unlink()
    assert "hash of downloaded file" in error_of(*words)
    assert not take.exists()


PORTAL = b"<html>Please log in</html>"
WRONG = {"checksums": r"txt:1: '../../x.amc sha"}
WRONG |= {"page": "07_01.amc: is a web page", "size": "more than 200 bytes"}
WRONG |= {"time": "07_01.amc: not complete after 0.5 s"}


@pytest.mark.parametrize("what", WRONG)
def test_nothing_else_is_written(site, tmp_path, monkeypatch, what):
    folder, address = site
    (out := tmp_path / "cmu").mkdir()
    (folder / "subjects" / "07" / "07_01.amc").write_bytes(
        b".\n" * 100 if what == "time" else PORTAL
    )
    monkeypatch.setattr(cmu, "MOST_SECONDS", 0.5 if what == "time" else 100.0)
    if what == "checksums":
        (out / "checksums.txt").write_text(
            "../../x.amc sha256:" + 64 * "0" + " http://127.0.0.1/x.amc"
        )
    monkeypatch.setattr(cmu, "MOST_BYTES", 200 if what == "size" else 10**6)
    with pytest.raises(DownloadError, match=WRONG[what]):
        download_cmu(out, [7], address)
    assert {path.name for path in out.rglob("*.*")} <= {"checksums.txt", "07.asf"}


NO_FILES = {"empty": b"", "blank": b" \n\n", "binary": bytes(range(256)) * 9, "text": b"busy\n"}


@pytest.mark.parametrize("name", ["07.asf", "07_01.amc"])
@pytest.mark.parametrize("answer", list(NO_FILES))
def test_an_answer_that_is_no_acclaim_file_is_not_kept(answer, name, site, tmp_path):
    folder, address = site
    (folder / "subjects" / "07" / name).write_bytes(NO_FILES[answer])
    with pytest.raises(DownloadError, match="the answer is"):
        download_cmu(tmp_path / "cmu", [7], address)
    assert not (tmp_path / "cmu" / "07" / name).exists()
    checksums = tmp_path / "cmu" / "checksums.txt"
    assert not checksums.exists() or name not in checksums.read_text()


def test_checksums_are_written_as_other_files_are(site, tmp_path, run):
    address = site[1]
    out = tmp_path / "cmu"
    out.mkdir()
    (tmp_path / "kept.txt").touch()
    (out / "checksums.txt").symlink_to(tmp_path / "kept.txt")
    run("download", "cmu", "--subjects", 7, "-o", out, "--site", address, "--quiet")
    assert (out / "checksums.txt").is_symlink()
    assert (tmp_path / "kept.txt").read_text().count(".a") == 2


def test_a_file_that_was_edited_is_kept(site, tmp_path, run, error_of):
    words = ["download", "cmu", "--subjects", 7, "-o", tmp_path / "cmu", "--site", site[1]]
    run(*words, "--quiet")
    take = tmp_path / "cmu" / "07" / "07_01.amc"
    take.write_text("# mine\n" + take.read_text())
    edited = take.read_bytes()
    assert "07_01.amc: differs from its checksum" in error_of(*words, "--quiet")
    assert take.read_bytes() == edited


def test_problems_are_said(site, tmp_path, monkeypatch, error_of):
    words = ["download", "cmu", "-o", tmp_path / "cmu", "--site"]
    assert "404" in error_of(*words, f"{site[1]}/none", "--subjects", 9)
    assert "Invalid URL" in error_of(*words, "nowhere", "--subjects", 7)
    monkeypatch.setitem(sys.modules, "pooch", None)
    assert "pip install numpy_cae[download]" in error_of(*words, site[1], "--subjects", 7)
