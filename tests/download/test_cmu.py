"""The CMU database, from a server on this machine."""

import io
import sys
import threading
import zipfile
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest
from acclaim_files import write_amc, write_asf

from data_synth import make_take
from numpy_cae.download import download_cmu
from numpy_cae.motion import find_motion_files, load_motion

pytest.importorskip("pooch", reason="needs the extra `download`")
PAGE = b"""<A HREF="subjects/07/07.asf">asf</A> <a href="subjects/07/07_01.amc">amc</a>
<A HREF="subjects/07/07_01.c3d">c3d</A> <a href="subjects/08/08_01.amc">of another subject</a>"""


@pytest.fixture
def site(tmp_path, monkeypatch):
    """A server, whose `files` are answered by path."""
    take = make_take("walk", 0, seconds=0.5, rate=120.0).motion
    write_asf(take.skeleton, tmp_path / "07.asf")
    write_amc(take, tmp_path / "07_01.amc")

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            body = self.files.get(self.path)
            self.send_response(404 if body is None else 200)
            self.send_header("Content-Length", str(len(body or b"")))
            self.end_headers()
            self.wfile.write(body or b"")

        def log_message(self, *_):
            pass

    Handler.files = {f"/subjects/07/{path.name}": path.read_bytes() for path in tmp_path.iterdir()}
    Handler.files["/search.php?subjectnumber=7"] = PAGE
    monkeypatch.setattr("time.sleep", lambda seconds: None)
    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    Handler.address = f"http://127.0.0.1:{server.server_port}"
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield Handler
    server.shutdown()
    thread.join()
    server.server_close()


def test_a_subject_and_its_checksums(site, tmp_path, capsys, run, error_of):
    words = ["download", "cmu", "--subjects", 7, "-o", tmp_path / "cmu", "--site", site.address]
    run(*words)
    printed = capsys.readouterr().out
    assert "NSF EIA-0196217" in printed and "2 files" in printed
    assert [len(load_motion(path)) for path in find_motion_files(tmp_path / "cmu")] == [60]
    take = tmp_path / "cmu" / "07" / "07_01.amc"
    site.files["/subjects/07/07_01.amc"] = b"another file"
    run(*words, "--quiet")  # the files are there already, and are not downloaded again
    assert (tmp_path / "cmu" / "checksums.txt").read_text().count("sha256:") == 2
    take.unlink()
    assert "hash of downloaded file" in error_of(*words)
    assert not take.exists()


def test_the_archive(site, tmp_path):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for path, body in site.files.items():
            archive.writestr(f"all{path}", body)
        archive.writestr("../../outside.amc", b"outside")
    site.files["/allasfamc.zip"] = buffer.getvalue()
    files = download_cmu(tmp_path / "cmu", site=site.address)
    assert {path.name for path in files} == {"07.asf", "07_01.amc", "outside.amc"}
    assert not list(tmp_path.glob("outside.amc"))


def test_problems_are_said(site, tmp_path, monkeypatch, error_of):
    words = ["download", "cmu", "-o", tmp_path / "cmu", "--site"]
    assert "404" in error_of(*words, site.address, "--subjects", 9)
    assert "unknown url type" in error_of(*words, "nowhere", "--subjects", 7)
    monkeypatch.setitem(sys.modules, "pooch", None)
    assert "pip install numpy_cae[download]" in error_of(*words, site.address)
