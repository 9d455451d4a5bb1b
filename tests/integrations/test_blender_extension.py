"""The zip that Blender installs, with wheels that only have names."""

import re
import tomllib
import zipfile

import pytest

import numpy_cae
from tools.blender_extension import BLENDER_VERSIONS, WHEEL_PLATFORMS, manifest, pack

NAMES = ("numpy_cae-0.4.0-py3-none-any.whl", "scipy-1.16.3-cp311-cp311-win_amd64.whl")


@pytest.fixture
def wheels(tmp_path):
    paths = [tmp_path / name for name in NAMES]
    for path in paths:
        path.write_bytes(b"a wheel")
    return paths


def test_the_zip_has_the_add_on_the_licence_and_the_wheels(tmp_path, wheels):
    with zipfile.ZipFile(pack(wheels, "windows-x64", "3.11", tmp_path / "dist")) as packed:
        names = set(packed.namelist())
    assert names == {
        *("blender_manifest.toml", "__init__.py", "LICENSE"),
        *(f"wheels/{name}" for name in NAMES),
    }


@pytest.mark.parametrize("python", BLENDER_VERSIONS)
@pytest.mark.parametrize("name", WHEEL_PLATFORMS)
def test_the_manifest_names_its_wheels_and_its_platform(wheels, name, python):
    entries = tomllib.loads(manifest(wheels, name, python))
    assert entries["wheels"] == [f"./wheels/{wheel}" for wheel in NAMES]
    assert entries["platforms"] == [name]


def test_no_two_pythons_of_blender_itself_are_for_one_version(wheels):
    older = tomllib.loads(manifest(wheels, "linux-x64", "3.11"))
    newer = tomllib.loads(manifest(wheels, "linux-x64", "3.13"))
    assert older["blender_version_max"] == newer["blender_version_min"]


def test_the_extension_has_the_version_of_the_package(wheels):
    version = tomllib.loads(manifest(wheels, "linux-x64", "3.11"))["version"]
    assert re.match(re.escape(version) + r"(\D|$)", numpy_cae.__version__)


def test_the_tagline_is_one_that_blender_accepts(wheels):
    tagline = tomllib.loads(manifest(wheels, "linux-x64", "3.11"))["tagline"]
    assert len(tagline) <= 64
    assert tagline[-1].isalnum()
