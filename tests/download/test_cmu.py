"""The CMU database, from a server on this machine."""

import io
import sys
import threading
import zipfile
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest
from acclaim_files import write_amc, write_asf

from data_synth import make_take
from numpy_cae.download import DownloadError, download_cmu
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
        promised = 0  # bytes that are announced and not sent

        def do_GET(self):
            body = self.files.get(self.path)
            promised = self.promised if self.path.endswith(".amc") else 0
            self.send_response(404 if body is None else 200)
            self.send_header("Content-Length", str(len(body or b"") + promised))
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


def test_a_subject_by_the_command(site, tmp_path, capsys, run):
    words = ["download", "cmu", "--subjects", 7, "-o", tmp_path / "cmu", "--site", site.address]
    run(*words)
    printed = capsys.readouterr().out
    assert "NSF EIA-0196217" in printed and "2 files" in printed
    assert [len(load_motion(path)) for path in find_motion_files(tmp_path / "cmu")] == [60]
    site.files.pop("/subjects/07/07_01.amc")  # is there already, and is not downloaded again
    run(*words, "--quiet")
    assert (tmp_path / "cmu" / "checksums.txt").read_text().count("sha256:") == 2


def test_a_file_that_disagrees_with_its_checksum_is_refused(site, tmp_path):
    folder = tmp_path / "cmu"
    download_cmu(folder, [7], site.address)
    (folder / "07" / "07_01.amc").unlink()
    site.files["/subjects/07/07_01.amc"] = b"another file"
    with pytest.raises(DownloadError, match="hash of downloaded file"):
        download_cmu(folder, [7], site.address)
    assert not (folder / "07" / "07_01.amc").exists()


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


def test_a_download_that_breaks_off_leaves_no_file(site, tmp_path):
    site.promised = 10
    with pytest.raises(DownloadError):
        download_cmu(tmp_path / "cmu", [7], site.address)
    assert [path.name for path in (tmp_path / "cmu" / "07").iterdir()] == ["07.asf"]


def test_problems_are_said(site, tmp_path, monkeypatch, error_of):
    words = ["download", "cmu", "-o", tmp_path / "cmu", "--site"]
    assert "404" in error_of(*words, site.address, "--subjects", 9)
    assert "unknown url type" in error_of(*words, "nowhere", "--subjects", 7)
    monkeypatch.setitem(sys.modules, "pooch", None)
    assert "pip install numpy_cae[download]" in error_of(*words, site.address)
