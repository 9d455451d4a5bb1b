"""A file is downloaded byte for byte, whatever the server does, or there is an error."""

import sys
import time

import numpy as np
import pytest
from misbehaving_site import Site, serve

from numpy_cae.download import DownloadError, fetch

BODY = np.random.default_rng(0).bytes(100_000)


@pytest.fixture
def site():
    with serve(Site({"/file": BODY, "/nothing": b""})) as site:
        yield site


@pytest.mark.parametrize("ranges", [True, False])
def test_a_connection_that_is_cut_goes_on_where_it_was_cut(site, tmp_path, ranges):
    site.cut, site.ranges = 30_000, ranges
    part, seen = tmp_path / "part", []
    if ranges:
        fetch(f"{site.address}/file", part, lambda *each: seen.append(each), pause=0)
        assert part.read_bytes() == BODY
        assert seen[-1] == (len(BODY), len(BODY))
        # Only the overlap was sent a second time.
        assert len(site.requests) == 4
        assert site.requests[1][1] == f"bytes={30_000 - 4096}-"
    else:
        with pytest.raises(DownloadError, match=r"30000 of 100000 bytes.*run the command again"):
            fetch(f"{site.address}/file", part, pause=0)
        assert part.read_bytes() == BODY[:30_000]
        site.cut = None
        fetch(f"{site.address}/file", part, pause=0)
        assert part.read_bytes() == BODY


@pytest.mark.parametrize("ranges", [True, False])
@pytest.mark.parametrize(
    "there", [BODY, b"x" * 50_000, BODY[:40_000] + b"other", BODY + b"more", BODY + b"x" * 9000]
)
def test_a_whole_part_is_used_and_one_of_another_file_is_begun_again(site, tmp_path, ranges, there):
    site.ranges = ranges
    (tmp_path / "part").write_bytes(there)
    fetch(f"{site.address}/file", tmp_path / "part", pause=0)
    assert (tmp_path / "part").read_bytes() == BODY


def test_a_promise_of_more_than_comes(site, tmp_path):
    site.promised = 10
    with pytest.raises(DownloadError, match=r"100000 of 100010|the server sent"):
        fetch(f"{site.address}/file", tmp_path / "part", pause=0)


def test_a_server_that_is_down_for_a_moment_and_one_that_stays_so(site, tmp_path):
    site.failing = 2
    fetch(f"{site.address}/file", tmp_path / "part", pause=0)
    assert (tmp_path / "part").read_bytes() == BODY
    site.failing = 100
    with pytest.raises(DownloadError, match="503"):
        fetch(f"{site.address}/file", tmp_path / "other", pause=0)


def test_what_is_not_there(site, tmp_path):
    with pytest.raises(DownloadError, match="404"):
        fetch(f"{site.address}/no", tmp_path / "part", pause=0)
    assert len(site.requests) == 1
    with pytest.raises(DownloadError, match="refused"):
        fetch("http://127.0.0.1:9/file", tmp_path / "part", pause=0)
    assert not list(tmp_path.iterdir())


def answering(status, headers, body=b"", seconds=0.0, times=1):
    """Sends the body so many times, with a pause after each."""

    def answer(handler):
        handler.wfile.write(f"HTTP/1.0 {status} X\r\n".encode())
        for name, value in headers.items():
            handler.wfile.write(f"{name}: {value}\r\n".encode())
        handler.wfile.write(b"\r\n")
        for _ in range(times):
            handler.wfile.write(body)
            time.sleep(seconds)

    return answer


def slow_headers(handler):
    handler.wfile.write(b"HTTP/1.0 200 OK\r\nX: ")
    for _ in range(100):
        handler.wfile.write(b"x")
        time.sleep(0.1)


def go(address):
    return answering(302, {"Location": address})


HOSTILE = {
    "a length of 5000 digits": answering(200, {"Content-Length": "9" * 5000}, b"x", times=10**7),
    "a length that is no number": answering(200, {"Content-Length": "-1e9"}, b"x" * 65536, 0, 999),
    "a range of 5000 digits": answering(206, {"Content-Range": f"bytes 0-1/{'9' * 5000}"}, b"xx"),
    "a range elsewhere": answering(206, {"Content-Range": "bytes 7-9/10"}, b"xxx"),
    "a length above the limit": answering(200, {"Content-Length": "1" + "0" * 15}, b"x"),
    "an endless body": answering(200, {}, bytes(65536), times=10**6),
    "a slow body": answering(200, {"Content-Length": 10**5}, b"x", 0.1, 100),
    "slow headers": slow_headers,
    "silence": lambda handler: time.sleep(10),
    "4 KB at a time": answering(200, {"Content-Length": 10**5}, bytes(4096)),
    "no address": go("http://[bad"),
    "a port that is none": go("http://127.0.0.1:99999/"),
    "a name that is too long": go(f"http://{'a' * 300}.example/"),
    "a local file": go("file:///etc/passwd"),
    "itself": go("/file"),
    "not HTTP": lambda handler: handler.wfile.write(b"SSH-2.0-x\r\n" * 99),
    "too many headers": answering(200, {f"X{n}": "x" for n in range(500)}, b"x"),
    "a header line without end": answering(200, {"X": "x" * 200_000}, b"x"),
}


@pytest.mark.parametrize("how", HOSTILE)
def test_a_hostile_server_ends_in_one_clear_error(site, tmp_path, monkeypatch, how):
    monkeypatch.setattr(sys.modules["numpy_cae.download.fetch"], "PATIENCE", 1.0)
    site.answer = HOSTILE[how]
    with pytest.raises(DownloadError) as refused:
        fetch(f"{site.address}/file", tmp_path / "part", pause=0, most=1_000_000)
    message = str(refused.value)
    assert message.startswith(f"{site.address}/file: ") and len(message) < 1000
    size = (tmp_path / "part").stat().st_size if (tmp_path / "part").exists() else 1
    assert 0 < size <= 1_000_000
