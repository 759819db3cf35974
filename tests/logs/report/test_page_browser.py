"""Reports and plots as a browser draws them: on a desktop and on a phone, in the light and the dark theme."""

from __future__ import annotations

from io import BytesIO

import matplotlib.image
import numpy as np
import pytest

from mavstack import open_log
from mavstack.logs.analysis import flights
from mavstack.logs.report import make_report
from mavstack.logs.report.charts import svg_document
from mavstack.logs.report.page import page_file, plot_page
from mavstack.logs.report.panels import PANELS, charts_of
from tests.logs.analysis.telemetry import flight_tlog
from tools.compilers import find

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]
playwright = pytest.importorskip("playwright.sync_api")

#: Width and height of screens, and their pixels in each of a page.
DESKTOP, PHONE = (1280, 900, 1), (390, 844, 2)
#: For each line: the colour, number of points and length, the place of its chart, and whether it is on top.
LINES = """() => [...document.querySelectorAll('polyline.line')].map(line => {
  const box = line.ownerSVGElement.getBoundingClientRect()
  return {colour: getComputedStyle(line).stroke.match(/[0-9.]+/g).map(Number),
          points: line.points.numberOfItems, length: line.getTotalLength(),
          box: [box.x, box.y + scrollY, box.width, box.height],
          top: [...line.parentNode.querySelectorAll('polyline')].at(-1) === line}
})"""
#: The places of the texts of each chart that are shown.
TEXTS = """() => [...document.querySelectorAll('figure svg')].map(svg => [...svg.querySelectorAll('text')]
  .map(text => text.getBoundingClientRect()).filter(box => box.width > 0)
  .map(box => [box.left, box.top, box.right, box.bottom]))"""


def wobble(telemetry):
    """Change every value all the time, with a fault at the end."""
    swing = np.sin(telemetry.time)
    telemetry.roll, telemetry.vibration = 0.3 * swing, 12 + 5 * swing
    telemetry.voltage, telemetry.rssi = 12.4 - telemetry.time / 100, round(200 + 9 * swing)
    telemetry.satellites = 14 + round(swing)
    if telemetry.time > 40:
        telemetry.texts = ((2, "Radio Failsafe"),)


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("flight") / "flight.tlog"
    path.write_bytes(flight_tlog(wobble))
    return open_log(path)


@pytest.fixture(scope="module")
def browser():
    path = find("chromium")
    if path is None:
        pytest.skip("no Chromium")
    with playwright.sync_playwright() as driver:
        opened = driver.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture
def show(browser, tmp_path):
    """Open a page; at the end of the test the console must be empty and nothing may have been downloaded."""
    contexts, problems = [], []

    def show(content, size=DESKTOP, theme="light", name="page.html"):
        file = tmp_path / name
        file.write_text(content, "utf-8")
        screen = {"width": size[0], "height": size[1]}
        contexts.append(browser.new_context(viewport=screen, color_scheme=theme, device_scale_factor=size[2]))
        page = contexts[-1].new_page()
        page.on("console", lambda message: problems.append(message.text))
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on(
            "request", lambda request: problems.append(request.url) if request.url != file.as_uri() else None
        )
        page.goto(file.as_uri())
        return page

    yield show
    for context in contexts:
        context.close()
    assert problems == []


def picture(page):
    """Return the whole page as an array of colours between 0 and 255."""
    return matplotlib.image.imread(BytesIO(page.screenshot(full_page=True)), format="png")[..., :3] * 255


def assert_lines(page, min_lines):
    """Assert that every line has points and a length, and return the lines."""
    lines = page.evaluate(LINES)
    assert len(lines) >= min_lines
    assert all(line["points"] > 50 and line["length"] > 100 for line in lines)
    return lines


def assert_painted(line, pixels, scale):
    """Assert that a line has pixels of its colour on the screen."""
    left, top, width, height = (round(number * scale) for number in line["box"])
    area = pixels[top : top + height, left : left + width]
    near = (np.abs(area - np.array(line["colour"][:3])) < 70).all(axis=2)
    assert near.sum() > 50, line


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("size", [DESKTOP, PHONE])
def test_the_report_is_drawn(show, log, size, theme):
    page = show(make_report(log).html, size, theme)
    assert page.evaluate("document.documentElement.scrollWidth") == size[0], (
        "nothing is wider than the screen"
    )
    assert page.locator(".finding.critical").count() == 1
    lines, pixels = assert_lines(page, 20), picture(page)
    for line in lines:
        if line["top"]:
            assert_painted(line, pixels, size[2])
    ground = pixels[2, 2].mean()
    assert ground < 60 if theme == "dark" else ground > 200


def test_no_text_of_a_zoomed_chart_is_cut(show, log):
    page = show(make_report(log).html)
    for _ in range(4):
        page.locator("button", has_text="+").first.click()
        edge = page.evaluate("document.querySelector('figure svg').getBoundingClientRect().right")
        assert all(right <= edge for boxes in page.evaluate(TEXTS) for _, _, right, _ in boxes)


@pytest.mark.parametrize("size", [DESKTOP, PHONE])
def test_the_texts_of_charts_can_be_read(show, log, size):
    charts = show(make_report(log).html, size).evaluate(TEXTS)
    assert len(charts) > 10
    for boxes in charts:
        assert len(boxes) >= 4
        assert all(bottom - top >= 9 for _, top, _, bottom in boxes)
        overlapping = [
            (one, two)
            for number, one in enumerate(boxes)
            for two in boxes[:number]
            if one[0] < two[2] and two[0] < one[2] and one[1] + 2 < two[3] and two[1] + 2 < one[3]
        ]
        assert overlapping == []


def test_plots_are_drawn(show, log):
    (flight,) = flights(log)
    charts = [chart for topic in PANELS for chart in charts_of(flight, topic)]
    page = show(plot_page("plot", charts[:1]), PHONE, "dark")
    (line,) = assert_lines(page, 1)
    assert_painted(line, picture(page), PHONE[2])
    assert_lines(show(svg_document(charts, page_file("page.css")), name="plots.svg"), 20)


def test_a_reader_can_zoom_move_the_cursor_and_add_fields(log, show):
    page = show(make_report(log).html)
    chart = page.locator("figure svg.live").first
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    across = [box["x"] + box["width"] * share for share in (0.3, 0.5, 0.6)]
    texts = chart.locator("text.x").all_inner_texts()
    page.mouse.move(across[0], box["y"] + 50)
    page.mouse.down()
    page.mouse.move(across[1], box["y"] + 50)
    page.mouse.up()
    assert chart.locator("text.x").all_inner_texts() != texts, "the axis shows a part"
    page.mouse.move(across[2], box["y"] + 50)
    assert " s" in page.locator(".tools output").inner_text()
    assert page.locator("svg.map circle.cursor").count() == 1
    page.fill("input[type=search]", "vibration_x")
    page.locator(".tree label:visible input").first.check()
    assert page.locator("#own figure figcaption").inner_text().startswith("VIBRATION.vibration_x")
    page.get_by_role("button", name="whole flight").click()
    assert chart.locator("text.x").all_inner_texts() == texts
