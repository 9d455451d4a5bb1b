"""Figures with sliders: what is embedded, and in Chromium what the controls change."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.mocap import body_positions
from numpy_cae.motion import PARENTS
from numpy_cae.viz import PROJECTED, Actor, Chart, Curve, slider_figure

X = np.linspace(-1.0, 1.0, 5)
SLOPES, SIZES = [1.0, 2.0, 4.0], [0.5, 1.0]


def a_figure(texts=6):
    walk = body_positions(make_take("walk", 0, seconds=1.0, rate=15.0).motion)
    slopes = np.repeat(SLOPES, len(SIZES))
    bodies = np.stack([size * walk for _ in SLOPES for size in SIZES])
    chart = Chart("", [Curve(X, np.outer(slopes, X), "y = a x")], "x", "y")
    panels = [chart, [Actor(bodies, PARENTS, "walk <b>", PROJECTED)]]
    said = [f"slope {slope:g}, row {row}" for row, slope in enumerate(slopes)]
    return slider_figure("a & b", {"a": SLOPES, "size": SIZES}, panels, said[:texts], 15.0)


def test_a_row_for_each_position_or_an_error():
    with pytest.raises(ValueError, match="5 rows or texts for 6 positions"):
        a_figure(texts=5)
    noise = np.random.default_rng(0).random((1, 60_000))
    with pytest.raises(ValueError, match="at most 300000"):
        slider_figure("large", {"a": [0.0]}, [Chart("", [Curve(noise, noise, "")], "", "")], [""])


def test_it_needs_no_network_and_says_in_words_what_it_draws():
    figure = a_figure()
    assert "http" not in figure.page.replace("http://www.w3.org/2000/svg", "")
    assert "<title>a &amp; b</title>" in figure.page and "<li>slope 4, row 5</li>" in figure.page
    assert repr(figure).splitlines()[1] == "slope 1, row 0"
    assert 'a figure with sliders: a &amp; b"' in figure._repr_html_()


@pytest.mark.parametrize("width", [1000, 390], ids=["desktop", "phone"])
def test_the_controls_change_the_drawing_and_the_sentence(browser, width):
    page, errors = browser.new_page(viewport={"width": width, "height": 700}), []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.set_content(a_figure()._repr_html_())
    frame = page.frame_locator("iframe")
    line = frame.locator("svg").first.locator("path[stroke]")
    before = line.get_attribute("d")
    assert frame.get_by_role("status").inner_text() == "slope 1, row 0"
    frame.get_by_role("slider").first.press("End")
    frame.get_by_label("size").press("ArrowRight")
    assert frame.get_by_role("status").inner_text() == "slope 4, row 5"
    assert line.get_attribute("d") != before
    body = frame.get_by_role("img", name="walk <b>").locator("path[stroke]")
    frame.get_by_role("button").click()
    still = body.get_attribute("d")
    frame.get_by_label("view").press("ArrowRight")
    assert body.get_attribute("d") != still and not errors
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.close()
