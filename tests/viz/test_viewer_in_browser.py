"""The viewer in headless Chromium: it loads from the disk, plays, and shows the right positions."""

import shutil

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.viz import motion_actor, save_viewer

playwright = pytest.importorskip("playwright.sync_api", reason="needs the extra `browser`")

OPTIONS = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
"""WebGL without a graphics card."""
SHOWN = """viewer => viewer.stage.figures.map(figure => figure.points.map(
    point => point.clone().add(figure.group.position).toArray()))"""

HEAD_ON_SCREEN = """viewer => {
    const figure = viewer.stage.figures[0], area = viewer.canvas.getBoundingClientRect();
    const head = figure.motion.names.indexOf("head");
    const seen = figure.points[head].clone().add(figure.group.position);
    seen.project(viewer.stage.camera);
    const x = (seen.x + 1) / 2 * area.width, y = (1 - seen.y) / 2 * area.height;
    return [area.left + x, area.top + y];
}"""


@pytest.fixture(scope="module")
def browser():
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


@pytest.fixture(scope="module")
def motions():
    return [make_take("walk", number, seconds=4.0, rate=30.0).motion for number in range(2)]


@pytest.fixture(scope="module", params=[(1200, 800), (390, 750)], ids=["desktop", "phone"])
def page(browser, motions, tmp_path_factory, request):
    """A page of both motions; no message in the console is an error."""
    actors = [motion_actor(motion, f"walk {n}") for n, motion in enumerate(motions)]
    path = tmp_path_factory.mktemp("page") / "walks.html"
    save_viewer(actors, path, 30.0)
    width, height = request.param
    opened = browser.new_page(viewport={"width": width, "height": height})
    errors = []
    opened.on("console", lambda line: errors.append(line.text) if line.type == "error" else None)
    opened.on("pageerror", lambda error: errors.append(str(error)))
    opened.goto(path.as_uri())
    opened.wait_for_function("window.motionViewers?.()[0]?.frame > 0", timeout=60_000)
    yield opened
    assert not errors
    opened.close()


def viewer_of(page):
    return page.evaluate_handle("motionViewers()[0]")


def test_scrubbing_shows_the_positions_of_the_motion(page, motions):
    frame = 47
    viewer_of(page).evaluate("(viewer, frame) => viewer.scrub(frame)", frame)
    page.locator("label", has_text="overlay").locator("input").check()
    for shown, motion in zip(viewer_of(page).evaluate(SHOWN), motions, strict=True):
        assert np.abs(np.array(shown) - motion.positions()[frame]).max() < 1e-3


def test_keys_buttons_and_toggles(page):
    viewer = viewer_of(page)
    page.locator(".viewer").press("Home")
    page.locator(".viewer").press("ArrowRight")
    page.locator(".viewer").press("Shift+ArrowRight")
    assert viewer.evaluate("viewer => [viewer.frame, viewer.playing]") == [31, False]
    page.get_by_title("play", exact=True).click()
    page.wait_for_function("motionViewers()[0].frame > 32", timeout=60_000)
    page.get_by_title("pause", exact=True).click()
    page.locator("label", has_text="walk 1").locator("input").uncheck()
    assert viewer.evaluate("viewer => viewer.stage.visible().length") == 1
    page.locator("select").select_option("0.25")
    assert viewer.evaluate("viewer => viewer.speed") == 0.25


def test_a_joint_is_named_under_the_pointer(page):
    viewer = viewer_of(page)
    viewer.evaluate("viewer => { viewer.scrub(20); viewer.stage.draw(); }")
    x, y = viewer.evaluate(HEAD_ON_SCREEN)
    page.mouse.move(x, y)
    assert "head" in page.locator(".joint").inner_text().lower()
