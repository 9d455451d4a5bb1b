"""Headless Chromium for the tests of pages."""

import shutil

import pytest

OPTIONS = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
"""WebGL without a graphics card."""


@pytest.fixture(scope="session")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="needs the extra `browser`")
    with playwright.sync_playwright() as chromium:
        found = shutil.which("chromium") or shutil.which("google-chrome")
        try:
            opened = chromium.chromium.launch(
                executable_path=found, args=[*OPTIONS, "--no-sandbox"]
            )
        except playwright.Error as error:
            pytest.skip(f"no Chromium: {str(error).splitlines()[0]}")
        yield opened
        opened.close()
