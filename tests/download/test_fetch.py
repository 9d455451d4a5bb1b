"""A file is downloaded byte for byte, whatever the server does, or there is an error."""

from __future__ import annotations

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
