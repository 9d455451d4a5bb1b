"""The viewer in headless Chromium: it loads from the disk, plays, and shows the right positions."""

import re
from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.viz import in_notebook, motion_actor, save_viewer
from numpy_cae.viz.actor import measure_distances

SHOWN = "viewer => viewer.stage.figures.map(figure => figure.points.map(point => point.toArray()))"
HEAD_ON_SCREEN = """viewer => {
    const figure = viewer.stage.figures[0], area = viewer.canvas.getBoundingClientRect();
    const pane = viewer.stage.panes().find(({ figures }) => figures.includes(figure));
    const [x, y] = viewer.stage.onScreen(pane, figure, figure.motion.names.indexOf("head"));
    return [area.left + x, area.top + y];
}"""
FOUND = [
    {"joint": "ltibia", "frames": [30, 45], "kind": "frozen", "cm": 131.2, "confidence": 0.9},
    {"joint": "lwrist", "frames": [50, 60], "kind": "frozen", "cm": 12.0},
    {"joint": "body", "frames": [60, 60], "kind": "spike", "cm": 1.25, "status": "proposed"},
    {"joint": "lwrist", "frames": [70, 71], "kind": "jumps", "status": "left"},
]


@pytest.fixture(scope="module")
def motions():
    return [make_take("walk", number, seconds=4.0, rate=30.0).motion for number in range(2)]


@pytest.fixture(scope="module", params=[(1200, 800), (390, 750)], ids=["desktop", "phone"])
def page(browser, motions, tmp_path_factory, request):
    """A page of both motions; no message in the console is an error."""
    actors = [motion_actor(motion, f"walk {n}") for n, motion in enumerate(motions)]
    path = tmp_path_factory.mktemp("page") / "walks.html"
    save_viewer(
        actors, path, 30.0, findings=FOUND, command="numpy-cae repair a.bvh -o b_finding_0.bvh"
    )
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


@pytest.mark.parametrize("findings", [(), FOUND], ids=["in a lesson", "with findings"])
def test_the_slider_stays_within_a_notebooks_frame_on_a_phone(browser, motions, findings):
    actors = [
        motion_actor(motion, f"a walk with a long name {n}") for n, motion in enumerate(motions)
    ]
    frame = in_notebook(actors, 30.0, findings)
    page = browser.new_page(viewport={"width": 390, "height": frame.height})
    page.set_content(frame.page)
    page.wait_for_function("window.motionViewers?.()[0]?.frame > 0", timeout=60_000)
    slider = page.locator(".viewer input[type=range]").bounding_box()
    stage = page.locator(".viewer .stage").bounding_box()
    page.close()
    assert 0 <= slider["y"] and slider["y"] + slider["height"] <= frame.height
    assert stage["height"] > 90


def viewer_of(page):
    return page.evaluate_handle("motionViewers()[0]")


def test_scrubbing_shows_the_positions_of_the_motion(page, motions):
    frame = 47
    viewer_of(page).evaluate("(viewer, frame) => viewer.scrub(frame)", frame)
    page.locator("label", has_text="overlay").locator("input").check()
    for shown, motion in zip(viewer_of(page).evaluate(SHOWN), motions, strict=True):
        assert np.abs(np.array(shown) - motion.positions()[frame]).max() < 1e-3


def test_keys_buttons_and_toggles(page):
    """The keys work on the page as it was opened, without a click into the viewer."""
    viewer = viewer_of(page)
    for key in ("Home", "ArrowRight", "Shift+ArrowRight"):
        page.keyboard.press(key)
    assert viewer.evaluate("viewer => [viewer.frame, viewer.playing]") == [31, False]
    assert page.url.endswith("#frame=31")
    page.get_by_title("play", exact=True).click()
    page.wait_for_function("motionViewers()[0].frame > 32", timeout=60_000)
    page.get_by_title("pause", exact=True).click()
    page.locator("label", has_text="walk 1").locator("input").uncheck()
    assert viewer.evaluate("viewer => viewer.stage.visible().length") == 1
    page.locator("label", has_text="walk 1").locator("input").check()
    page.get_by_label("speed", exact=True).select_option("0.25")
    assert viewer.evaluate("viewer => viewer.speed") == 0.25
    page.keyboard.press("Escape")


def test_the_address_names_a_frame(page):
    page.evaluate("location.hash = '#frame=58'")
    page.wait_for_function("motionViewers()[0].frame === 58")
    assert page.get_by_label("frame number").input_value() == "58"


def test_a_finding_leads_to_its_frames_and_its_command(page):
    """The details are beside the list, on a phone below its line; a command for those that are
    kept, and for it alone. The curve is of the joint below it that moved furthest."""
    viewer, code = viewer_of(page), page.locator(".findings code:visible")
    detail = page.locator(".findings .detail")
    rows = page.locator(".findings li")
    first, proposal = rows.first, rows.nth(2)
    assert page.locator("h2").last.inner_text() == "1 found, left alone"
    viewer.evaluate("viewer => viewer.setPlaying(false)")  # else it plays on before it is asked
    first.locator("button").first.click()
    assert viewer.evaluate("viewer => [viewer.frame, viewer.loop]") == [30, [20, 55]]
    mover = re.search(r"frames 30 to 45 · frozen · the (l\w+) moves 131 cm", first.inner_text())[1]
    assert page.get_by_label("curve of").input_value() == mover
    assert "Confidence 90%" in detail.inner_text()
    assert first.locator(".detail").count() == int(page.viewport_size["width"] < 500)
    detail.locator("summary").click()
    assert code.inner_text() == "numpy-cae repair a.bvh -o b_finding_1.bvh --only 1"
    detail.get_by_label("keep this repair").uncheck()
    assert code.first.inner_text() == "numpy-cae repair a.bvh -o b_kept.bvh --only 2"
    detail.get_by_label("keep this repair").check()
    proposal.locator("button").first.click()
    assert code.inner_text() == "numpy-cae repair a.bvh -o b_finding_3.bvh --only 3"


def test_the_chosen_joint_is_drawn_five_frames_before_and_after(page, motions):
    page.locator("label", has_text="overlay").locator("input").check()
    page.get_by_label("curve of").select_option("lwrist")
    trails = viewer_of(page).evaluate("""viewer => {
        viewer.scrub(50);
        return viewer.stage.figures.map(({ trail }) => [0, 10].map((skin) =>
            [...trail.balls.instanceMatrix.array.slice(16 * skin + 12, 16 * skin + 15)]));
    }""")
    for shown, motion in zip(trails, motions, strict=True):
        wrist = motion.skeleton.index("lwrist")
        np.testing.assert_allclose(shown, motion.positions()[[45, 55], wrist], atol=1e-3)


def test_a_film_of_the_loop_is_saved(page):
    viewer_of(page).evaluate("viewer => { viewer.mark(0, 3); viewer.mark(1, 9); }")
    with page.expect_download(timeout=60_000) as download:
        page.get_by_title("film", exact=False).click()
    assert download.value.suggested_filename == "walk_0_walk_1.webm"
    with open(download.value.path(), "rb") as film:
        assert film.read(4) == b"\x1aE\xdf\xa3"  # as every WebM file begins
    page.keyboard.press("c")


def test_equal_bodies_look_equal_side_by_side(page):
    """Each body has the same camera, so that a joint is at the same place of each picture."""
    viewer_of(page).evaluate("viewer => { viewer.overlayBox.checked = false; viewer.arrange(); }")
    gap = viewer_of(page).evaluate("""viewer => {
        const [one, other] = viewer.stage.panes(), [a, b] = viewer.stage.figures;
        b.points.forEach((point, joint) => point.copy(a.points[joint]));
        const [x, y] = viewer.stage.onScreen({ ...other, anchor: one.anchor }, b, 3);
        const [u, v] = viewer.stage.onScreen(one, a, 3);
        return [x - other.left - u + one.left, y - other.top - v + one.top];
    }""")
    assert np.abs(gap).max() < 1e-6


def test_left_and_right_differ_and_a_standing_foot_is_marked(page):
    left, right, planted = viewer_of(
        page
    ).evaluate("""({ stage: { figures: [{ motion, balls, own }] } }) => [
        ...["lwrist", "rwrist"].map((name) => {
            const shade = own.clone();
            balls.getColorAt(motion.names.indexOf(name), shade);
            return shade.getHSL({}).l;
        }),
        [...motion.planted.values()].map((each) => each.filter(Boolean).length / each.length)]""")
    assert left > right + 0.1
    assert planted and all(0.2 < share < 0.9 for share in planted)  # of the frames of a walk


def test_drawing_becomes_lighter_where_it_is_slow(page):
    """Twice, and back where it is fast; the camera and the frame stay."""
    viewer = viewer_of(page)
    before, after, slow, fast = viewer.evaluate("""viewer => {
        viewer.scrub(20);
        viewer.lighter = 0, viewer.tooHeavy = [0, 0];
        const at = () => [...viewer.stage.camera.position, viewer.stage.frame];
        const before = at();
        for (let i = 0; i < 90; i++) viewer.measure(0.1);
        const slow = viewer.lighter;
        for (let i = 0; i < 900; i++) viewer.measure(0.01);
        return [before, at(), slow, viewer.lighter];
    }""")
    np.testing.assert_allclose(after, before)
    assert (slow, fast) == (2, 0)


def test_a_joint_is_named_under_the_pointer(page):
    viewer = viewer_of(page)
    viewer.evaluate("viewer => { viewer.scrub(20); viewer.stage.draw(); }")
    page.locator(".stage canvas").scroll_into_view_if_needed()
    page.mouse.move(*viewer.evaluate(HEAD_ON_SCREEN))
    assert "head" in page.locator(".joint").inner_text().lower()


@pytest.fixture
def changed(browser, motions, tmp_path):
    """A dark page of a walk, one whose wrists are 7.07 cm away, the middle of the scale, and one
    with its wrists a metre to the side."""
    first = motion_actor(motions[0], "before")
    moved, wide = first.positions.copy(), first.positions.copy()
    wrists = [first.names.index(f"{side}wrist") for side in "lr"]
    moved[:, wrists] += [0.0, 0.0707, 0.0]
    wide[:, wrists] += [1.0, 0.0, 0.0]
    path = tmp_path / "changed.html"
    near = measure_distances(replace(first, positions=moved), first)
    save_viewer([first, near, replace(first, positions=wide)], path, 30.0)
    opened = browser.new_page(viewport={"width": 1200, "height": 700}, color_scheme="dark")
    opened.goto(path.as_uri())
    opened.wait_for_function("window.motionViewers?.()[0]?.frame > 0", timeout=60_000)
    yield opened
    opened.close()


def test_a_distance_has_one_colour_on_either_side(changed):
    colours = viewer_of(changed).evaluate("""({ stage: { figures: [, { motion, balls, own }] } }) =>
        ["lwrist", "rwrist"].map((name) => {
            balls.getColorAt(motion.names.indexOf(name), own);
            return own.getStyle();
        })""")
    scale = changed.locator(".ticks i").evaluate("box => box.style.background")
    assert colours[0] == colours[1] and colours[0].replace(",", ", ") in scale


def test_paper_is_light_and_has_the_picture(changed):
    """Also where the page is dark: the corner of the picture has the colour of a light page."""
    changed.evaluate("dispatchEvent(new Event('beforeprint'))")
    corner = changed.evaluate("""() => {
        const papers = document.querySelectorAll(".stage canvas:not([hidden])");
        return [papers.length, ...papers[0].getContext("2d").getImageData(0, 0, 1, 1).data];
    }""")
    assert corner == [1, 238, 241, 244, 255]
    changed.evaluate("dispatchEvent(new Event('afterprint'))")
    assert viewer_of(changed).evaluate("viewer => viewer.canvas.hidden") is False


def test_bodies_stay_in_the_picture_where_it_becomes_narrow(changed):
    changed.set_viewport_size({"width": 420, "height": 2000})
    changed.wait_for_function("motionViewers()[0].stage.width < 500")
    across = viewer_of(changed).evaluate("""({ stage }) => stage.panes().flatMap((pane) =>
        pane.figures[0].points.map((_, joint) =>
            (stage.onScreen(pane, pane.figures[0], joint)[0] - pane.left) / pane.width))""")
    assert 0 < min(across) and max(across) < 1


def test_findings_of_an_event_are_one_line_that_unfolds(browser, motions, tmp_path):
    first = motion_actor(motions[0], "before")
    findings = [
        {"joint": "lwrist", "frames": [19, 83], "kind": "frozen", "event": 0, "place": "left arm"},
        {"joint": "lradius", "frames": [28, 73], "kind": "frozen", "event": 0, "place": "left arm"},
        {"joint": "rwrist", "frames": [50, 60], "kind": "frozen", "event": 1, "place": "rwrist"},
    ]
    path = tmp_path / "events.html"
    save_viewer([first], path, 30.0, findings=findings)
    opened = browser.new_page(viewport={"width": 1200, "height": 700})
    opened.goto(path.as_uri())
    opened.wait_for_function("window.motionViewers?.()[0]?.frame > 0", timeout=60_000)
    summary = opened.locator(".event summary")
    assert summary.count() == 1
    assert "left arm" in summary.inner_text() and "frames 19 to 83" in summary.inner_text()
    buttons = opened.locator(".findings ol button")
    assert buttons.nth(1).is_visible()  # the event of the finding with which the page begins
    summary.click()
    assert [buttons.nth(number).is_visible() for number in range(3)] == [False, False, True]
    assert buttons.nth(2).inner_text().startswith("3. rwrist")
    opened.close()
