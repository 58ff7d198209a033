"""The page in a real browser: real clicks and keys, light, dark, on a phone, without the network, under attack."""

import pytest

from tests.replay.browser import BROWSER, opened
from tests.report.page import Page
from tests.report.test_page import hostile
from visitlab_cli.report.making import gather
from visitlab_cli.report.page import render

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no chromium; on Debian install chromium")
CHART = "[data-chart='0']"
CONTRASTS = """
    (() => {
      const canvas = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
      const parts = (colour) => { canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = colour; canvas.fillRect(0, 0, 1, 1);
        return [...canvas.getImageData(0, 0, 1, 1).data]; };
      const light = (colour) => parts(colour).slice(0, 3).map((part) => part / 255)
        .map((part) => part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4)
        .reduce((sum, part, i) => sum + part * [0.2126, 0.7152, 0.0722][i], 0);
      const shown = (node) => getComputedStyle(node).backgroundColor;
      const behind = (node) => (node.parentElement && parts(shown(node))[3] === 0 ?
        behind(node.parentElement) : shown(node));
      const found = {};
      for (const node of document.querySelectorAll("h1, h2, h3, p, td, th, small, a, button, dt, dd, li, b")) {
        if (!node.textContent.trim() || !node.checkVisibility()) continue;
        const [a, b] = [light(getComputedStyle(node).color), light(behind(node))];
        const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
        if (ratio < 4.5) found[`${node.tagName} ${node.className} ${node.textContent.slice(0, 20)}`] = ratio;
      }
      return found;
    })()
"""


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with opened(tmp_path_factory.mktemp("profile")) as browser:
        yield browser


@pytest.fixture
def page(browser, tiny_page):
    page = Page(browser, tiny_page)
    page.until("document.querySelector('.plot svg')")
    yield page
    assert page.complaints() == []


def curves(page):
    return page.count(f"{CHART} .plot polyline.curve")


def step(page):
    return int(page.text(".step-facts dd").split()[0])


def test_nothing_is_asked_of_the_network_nor_could_be(browser, tiny_page):
    page = Page(browser, tiny_page)
    assert page.value("performance.getEntriesByType('resource').length") == 0
    assert page.complaints() == []
    assert page.value("fetch('http://127.0.0.1:9/').then(() => 'asked', () => 'refused')") == "refused"
    page.value("document.body.append(Object.assign(new Image(), {src: 'http://127.0.0.1:9/x.png'}))")
    page.value(
        "(() => { const script = document.createElement('script'); script.textContent = 'document.title = 1';"
        "document.body.append(script); })()"
    )
    page.until("window.complaints.length >= 3")
    assert page.value("document.title") != "1"


def test_conditions_are_switched_off_and_on(page):
    everything = curves(page)
    assert everything == page.count(f"{CHART} .name") == 5
    page.click(f"{CHART} .name")
    assert curves(page) == everything - 1
    assert page.value(f'document.querySelector("{CHART} .name").ariaPressed') == "false"
    page.click(f"{CHART} .name")
    assert curves(page) == everything
    page.click(f"{CHART} .name:nth-of-type(2)", shift=True)
    assert curves(page) == 1
    page.click(f"{CHART} .names > :last-child")
    assert curves(page) == everything


def test_a_chart_is_read_with_the_pointer_and_with_keys(page):
    assert page.value(f'document.querySelector("{CHART} .tip").hidden')
    page.hover(f"{CHART} .plot", 0.7)
    first = page.value("DATA.charts[0]")
    told = page.text(f"{CHART} .tip")
    for curve in first["curves"]:
        assert curve["name"] in told
    page.value(f'document.querySelector("{CHART} .plot").focus()')
    page.press("ArrowRight")
    before = page.text(f"{CHART} .tip b")
    page.press("ArrowRight", 3)
    assert page.text(f"{CHART} .tip b") != before
    assert page.text(f"{CHART} .unseen").startswith(page.text(f"{CHART} .tip b"))


def test_the_trial_plays_pauses_and_is_stepped_through(page):
    captions = page.value("DATA.trials[0].captions")
    assert step(page) == 0
    page.click(".controls .main")
    page.until("+document.querySelector('.rail input').value >= 3")
    page.click(".controls .main")
    assert page.text(".controls .main") == "Play"
    page.click(".stage .lab")
    page.value("document.querySelector('.stage').focus()")
    at = step(page)
    page.press("ArrowRight")
    assert step(page) == at + 1
    assert page.text(".caption") == f"{captions[at + 1]}."
    page.press("ArrowLeft")
    assert step(page) == at
    page.press(" ")
    page.until(f"+document.querySelector('.rail input').value >= {at + 2}")
    page.press(" ")
    page.click(".timeline", 0.995)
    assert step(page) == len(captions) - 1


def test_a_moment_and_another_visit_are_chosen(page):
    moments = page.value("DATA.trials[0].moments")
    page.click(".moments li:last-child button")
    assert step(page) == moments[-1][0]
    page.value("document.getElementById('visit').focus()")
    page.press("ArrowRight")
    page.until("document.querySelector('.about').textContent.startsWith(DATA.trials[1].cell)")
    assert step(page) == 0


def test_the_drawing_is_where_the_log_says(page):
    page.value("document.querySelector('.stage').focus()")
    page.press("ArrowRight", 7)
    columns = page.value("DATA.trials[0].columns")
    for who in ("robot", "human"):
        place = f"translate({columns[f'{who}_col'][7] + 0.5:.3f},{columns[f'{who}_row'][7] + 0.5:.3f})"
        assert page.value(f"document.querySelector('.lab g.{who}').getAttribute('transform')").startswith(place)
    room = columns["goal_room"][7]
    assert page.value("document.querySelector('.lab .goal').getAttribute('transform')").startswith(
        f"translate({room % 3 * 8:.3f},{room // 3 * 8:.3f})"
    )


def test_every_control_is_reached_by_the_tab_key(page):
    wanted = page.value("document.querySelectorAll('button, select, input, summary, .plot, .stage').length")
    reached = set()
    for _ in range(wanted + 60):
        page.press("Tab")
        reached.add(page.value("[...document.querySelectorAll('*')].indexOf(document.activeElement)"))
    for selector in (".plot", ".stage", ".controls .main", "#visit", ".rail input", "summary", "#theme", ".name"):
        assert (
            page.value(f"[...document.querySelectorAll('*')].indexOf(document.querySelector({selector!r}))") in reached
        )


@pytest.mark.parametrize("dark", [False, True])
def test_light_and_dark_can_be_read(browser, tiny_page, dark):
    page = Page(browser, tiny_page, dark=dark)
    page.until("document.querySelector('.plot svg')")
    background = page.value("getComputedStyle(document.body).backgroundColor")
    assert page.value(CONTRASTS) == {}
    page.click("#theme")
    assert page.value("getComputedStyle(document.body).backgroundColor") != background
    assert page.value(CONTRASTS) == {}
    assert page.complaints() == []


def test_on_a_phone_nothing_is_wider_than_the_screen(browser, tiny_page):
    page = Page(browser, tiny_page, width=390, height=844)
    page.until("document.querySelector('.plot svg')")
    assert page.value("document.documentElement.scrollWidth") == 390
    small = (
        "[...document.querySelectorAll('button, select')].filter((n) => n.offsetHeight && n.offsetHeight < 36).length"
    )
    assert page.value(small) == 0
    page.click(".controls .main")
    page.until("+document.querySelector('.rail input').value >= 1")
    assert page.complaints() == []


def test_copy_takes_the_command(page):
    page.click("[data-copy='command']")
    page.until("['Copied', 'Selected'].includes(document.querySelector('[data-copy]').textContent)")


def test_an_attack_in_every_name_does_nothing(browser, tiny_run, tmp_path):
    file = tmp_path / "hostile.html"
    file.write_text(render(*hostile(gather(tiny_run))))
    page = Page(browser, file)
    page.until("document.querySelector('.plot svg')")
    page.hover(".plot")
    page.click(".moment")
    assert page.count("img") == 0
    assert page.count("script") == 2
    assert page.value("document.title") != "hurt"  # though the title holds the run's name
    assert page.complaints() == []
