"""The CMU database from a correct site, and from sites that send wrong or dangerous files."""

import io
import zipfile

import pytest
from acclaim_files import write_amc, write_asf
from misbehaving_site import Site, serve

from data_synth import make_take
from numpy_cae.cli import main
from numpy_cae.download import CmuSite, DownloadError, download_cmu
from numpy_cae.errors import FileError
from numpy_cae.lock import lock
from numpy_cae.motion import find_motion_files, load_motion

PAGE = """<TD><A HREF="http://other:8080/subjects/07/07.asf">asf</A>
<a href="subjects/07/07_01.amc">amc</a><A HREF="subjects/07/07_02.amc">amc</A>
<A HREF="subjects/07/07_01.c3d">c3d</A> <a href="subjects/08/08_01.amc">another's</a>"""


@pytest.fixture(scope="module")
def acclaim(tmp_path_factory):
    """A skeleton and two takes, as bytes by name."""
    folder = tmp_path_factory.mktemp("acclaim")
    takes = [make_take("walk", seed, seconds=0.5, rate=120.0) for seed in (0, 0)]
    write_asf(takes[0].motion.skeleton, folder / "07.asf")
    write_amc(takes[0].motion, folder / "07_01.amc")
    write_amc(takes[1].motion, folder / "07_02.amc")
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture
def site(acclaim):
    files = {f"/subjects/07/{name}": body for name, body in acclaim.items()}
    files["/search.php?subjectnumber=7"] = PAGE.encode()
    with serve(Site(files)) as site:
        yield site


def polite(site):
    return CmuSite(site.address, pause=0)


def packed(files: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, body in files.items():
            archive.writestr(name, body)
    return buffer.getvalue()


def names(folder):
    found = [*folder.rglob("*.asf"), *folder.rglob("*.amc"), *folder.rglob("*.zip")]
    return sorted(path.relative_to(folder).as_posix() for path in found)


def test_a_subject_by_the_command(site, tmp_path, capsys, run):
    argv = ["download", "cmu", "--subjects", 7, "-o", tmp_path, "--site", site.address]
    run(*argv)
    printed = capsys.readouterr()
    assert "NSF EIA-0196217" in printed.out
    assert "3 new files, 0 downloaded before" in printed.out
    assert "07_02.amc" in printed.err
    assert names(tmp_path) == ["07/07.asf", "07/07_01.amc", "07/07_02.amc"]
    assert [len(load_motion(path)) for path in find_motion_files(tmp_path)] == [60, 60]
    run(*argv)
    assert "0 new files, 3 downloaded before" in capsys.readouterr().out


def test_half_a_file_never_stands_under_its_name(site, tmp_path, acclaim):
    site.cut, site.ranges = 5000, False
    with pytest.raises(DownloadError):
        download_cmu(tmp_path, [7], polite(site))
    for path in (tmp_path / "07").glob("[0-9]*"):
        assert path.read_bytes() == acclaim[path.name]
    site.cut = None
    tally = download_cmu(tmp_path, [7], polite(site))
    assert tally.new + tally.known == 3
    assert (tmp_path / "07" / "07_02.amc").read_bytes() == acclaim["07_02.amc"]


def test_what_does_not_parse_is_left_out_and_said(site, tmp_path, capsys, acclaim):
    site.files["/subjects/07/07_01.amc"] = b"<html>out of order</html>\n"
    argv = ["download", "cmu", "--subjects", "7", "-o", str(tmp_path), "--site", site.address]
    assert main(argv) == 2
    lines = capsys.readouterr().err.splitlines()
    assert any(line.startswith("left out: 07_01.amc: line 1") for line in lines)
    assert "1 downloaded files cannot be read" in lines[-1]
    assert names(tmp_path) == ["07/07.asf", "07/07_02.amc"]


def test_the_archive(site, tmp_path, acclaim):
    body = {f"all_asfamc/subjects/07/{name}": body for name, body in acclaim.items()}
    site.files["/allasfamc.zip"] = packed({**body, "all_asfamc/README": b"read me"})
    site.cut = 10_000
    assert download_cmu(tmp_path, None, polite(site)).new == 3
    assert names(tmp_path) == ["07/07.asf", "07/07_01.amc", "07/07_02.amc", "allasfamc.zip"]
    (tmp_path / "07" / "07_01.amc").unlink()
    again = download_cmu(tmp_path, None, polite(site))
    assert (again.new, again.known) == (1, 2)
    assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize(
    "climbing",
    ["../07_09.amc", "a/../../07_09.amc", "/tmp/07_09.amc", "..\\07_09.amc", "C:/x/07_09.amc",
     "../../.profile"],
)  # fmt: skip
def test_an_archive_that_climbs_out(site, tmp_path, acclaim, climbing):
    site.files["/allasfamc.zip"] = packed({"07/07.asf": acclaim["07.asf"], climbing: b"x"})
    folder = tmp_path / "inner" / "cmu"
    folder.mkdir(parents=True)
    with pytest.raises(DownloadError, match="leaves the folder"):
        download_cmu(folder, None, polite(site))
    assert names(tmp_path) == []


def test_an_archive_that_is_damaged_or_none(site, tmp_path, acclaim):
    whole = packed({f"07/{name}": body for name, body in acclaim.items()})
    middle = len(whole) // 2
    site.files["/allasfamc.zip"] = whole[:middle] + bytes(200) + whole[middle + 200 :]
    with pytest.raises(DownloadError, match=r"damaged; it was removed"):
        download_cmu(tmp_path / "a", None, polite(site))
    site.files["/allasfamc.zip"] = whole
    tally = download_cmu(tmp_path / "a", None, polite(site))
    assert tally.new + tally.known == 3
    site.files["/allasfamc.zip"] = b"<html>moved</html>"
    with pytest.raises(DownloadError, match="no zip archive"):
        download_cmu(tmp_path / "b", None, polite(site))
    assert not [path for path in tmp_path.rglob("*") if path.name.endswith(".part")]
    assert names(tmp_path / "b") == []


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ({"07/07_01.amc": bytes(40_000_000)}, "more than 50 times"),
        ({f"07/07_{n:02d}.amc": bytes(900_000) for n in range(60)}, "more than 50 times"),
        ({"07/07_01.amc": bytes(70_000_000)}, "expected at most"),
        ({"README": b"read me"}, "no motion file"),
    ],
)
def test_an_archive_that_expands_or_holds_nothing_is_removed(site, tmp_path, body, message):
    site.files["/allasfamc.zip"] = packed(body)
    with pytest.raises(DownloadError, match=message):
        download_cmu(tmp_path, None, polite(site))
    assert list(tmp_path.iterdir()) == []


def test_a_page_of_any_length_is_not_read(site, tmp_path):
    site.files["/search.php?subjectnumber=7"] = bytes(4_100_000)
    with pytest.raises(DownloadError, match="more than 4000000 bytes"):
        download_cmu(tmp_path, [7], polite(site))
    assert list(tmp_path.iterdir()) == []


def test_a_link_in_the_folder_is_not_followed(site, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "cmu").mkdir()
    (tmp_path / "cmu" / "07").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(DownloadError, match="link"):
        download_cmu(tmp_path / "cmu", [7], polite(site))
    assert not list((tmp_path / "elsewhere").iterdir())


def test_one_at_a_time_in_a_folder(site, tmp_path):
    with lock(tmp_path / "download"), pytest.raises(FileError, match="another"):
        download_cmu(tmp_path, [7], polite(site))
    assert download_cmu(tmp_path, [7], polite(site)).new == 3


def test_a_subject_that_is_not_there_and_a_site_that_is_none(site, tmp_path, error_of):
    argv = ["download", "cmu", "--subjects", 9, "-o", tmp_path, "--site"]
    assert "404" in error_of(*argv, site.address)
    assert "not the address" in error_of(*argv, "ftp://x")


@pytest.mark.parametrize("promised", [-1, -3000])
def test_a_length_that_is_too_short_is_noticed(site, tmp_path, promised):
    site.files["/search.php?subjectnumber=7"] += b" " * 4000
    site.promised = promised
    tally = download_cmu(tmp_path, [7], polite(site))
    assert tally.new == 0
    assert len(tally.refused) == 3
    assert names(tmp_path) == []
