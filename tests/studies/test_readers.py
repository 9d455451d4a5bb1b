"""Readers and writers of BVH beside each other; here those that need no other package."""

import sys
from types import SimpleNamespace

import pytest

from numpy_cae.mocap import load_motion, write_bvh
from studies import readers


@pytest.fixture
def rows(monkeypatch):
    monkeypatch.setattr(readers, "SECONDS", (2.0,))
    monkeypatch.setattr(readers, "READERS", {"missing": "", "reader": "read", "both": "read"})
    monkeypatch.setattr(readers, "WRITERS", {"missing": "", "both": "write"})
    monkeypatch.setitem(sys.modules, "reader", SimpleNamespace(read=load_motion))
    both = SimpleNamespace(read=load_motion, write=write_bvh)
    monkeypatch.setitem(sys.modules, "both", both)
    (table,) = readers.run(rounds=1).tables
    return table.rows


def test_packages_that_are_not_installed_are_left_out(rows):
    assert [package for _, package, *_ in rows] == ["numpy_cae", "reader", "both"]


def test_speed_is_the_size_over_the_time(rows):
    for megabytes, _, milliseconds, speed, *_ in rows:
        assert speed == pytest.approx(1e3 * megabytes / milliseconds)


def test_what_only_reads_has_no_speed_of_writing(rows):
    ours, reader, both = rows
    assert reader[4:] == [None, None]
    assert ours[5] > 0.1 and both[5] > 0.1
