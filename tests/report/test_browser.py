"""The page in a real browser: real clicks and keys, light, dark, on a phone, without the network, under attack."""

import pytest

from tests.browser import needs_browser, opened
from tests.report.test_page import hostile
from visitlab_cli.log.reader import read_trial
from visitlab_cli.report.making import gather
from visitlab_cli.report.page import render

pytestmark = needs_browser
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


COMPLAINTS = """
    window.complaints = [];
    addEventListener("error", (event) => complaints.push(event.message));
    addEventListener("unhandledrejection", (event) => complaints.push(String(event.reason)));
    addEventListener("securitypolicyviolation", (event) => complaints.push("policy: " + event.violatedDirective));
"""
BROKEN_NUMBERS = """
    (() => {
      const broken = [], walker = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
      for (let text = walker.nextNode(); text; text = walker.nextNode()) {
        if (text.parentElement.closest("pre, svg, option, .unseen") || !text.parentElement.checkVisibility()) continue;
        for (const number of text.data.matchAll(/[-+]?\\d[\\d.,]*/g)) {
          const range = document.createRange();
          range.setStart(text, number.index);
          range.setEnd(text, number.index + number[0].length);
          if (new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size > 1) broken.push(number[0]);
        }
      }
      return broken;
    })()
"""
OVERLAPS = """
    [...document.querySelectorAll(".numbers tbody tr")].flatMap((row) => {
      const drawn = [...row.children].map((cell) => {
        const range = document.createRange();
        range.selectNodeContents(cell);
        return range.getBoundingClientRect();
      });
      return drawn.flatMap((a, i) => drawn.slice(i + 1).filter((b) => a.left < b.right - 1 && b.left < a.right - 1
        && a.top < b.bottom - 1 && b.top < a.bottom - 1).map(() => row.textContent));
    })
"""
PHONE = {"viewport": {"width": 390, "height": 844}, "is_mobile": True, "has_touch": True}


@pytest.fixture(scope="module")
def browser():
    with opened() as browser:
        yield browser


@pytest.fixture
def shown(browser):
    """Opens a file in a tab of its own, with playwright's options of a context."""
    contexts = []

    def show(file, **options):
        context = browser.new_context(**{"viewport": {"width": 1200, "height": 900}, **options})
        contexts.append(context)
        page = context.new_page()
        page.add_init_script(COMPLAINTS)
        page.goto(file.absolute().as_uri())
        page.locator(".plot svg").first.wait_for()
        return page

    yield show
    for context in contexts:
        context.close()


@pytest.fixture
def page(shown, tiny_page):
    page = shown(tiny_page)
    yield page
    assert complaints(page) == []


def complaints(page):
    return page.evaluate("window.complaints")


def curves(page):
    return page.locator(f"{CHART} .plot polyline.curve").count()


def step(page):
    return int(page.locator(".step-facts dd").first.text_content().split()[0])


def plays_to(page, wanted):
    """Waits until the trial has been played to a step, looked at from here: the page allows no code from elsewhere."""
    for _ in range(200):
        if int(page.locator(".rail input").input_value()) >= wanted:
            return
        page.wait_for_timeout(50)
    raise AssertionError(f"never came to step {wanted}")


def along(page, selector, share):
    """Where to point to on an element, `share` of its width from its left."""
    box = page.locator(selector).first.bounding_box()
    return {"x": box["width"] * share, "y": box["height"] / 2}


def test_nothing_is_asked_of_the_network_nor_could_be(shown, tiny_page):
    page = shown(tiny_page)
    assert page.evaluate("performance.getEntriesByType('resource').length") == 0
    assert complaints(page) == []
    assert page.evaluate("fetch('http://127.0.0.1:9/').then(() => 'asked', () => 'refused')") == "refused"
    page.evaluate("document.body.append(Object.assign(new Image(), {src: 'http://127.0.0.1:9/x.png'}))")
    page.evaluate(
        "(() => { const script = document.createElement('script'); script.textContent = 'document.title = 1';"
        "document.body.append(script); })()"
    )
    page.wait_for_timeout(200)
    assert len(complaints(page)) >= 3
    assert page.title() != "1"


def test_conditions_are_switched_off_and_on(page):
    everything = curves(page)
    names = page.locator(f"{CHART} .name")
    assert everything == names.count() == 5
    names.first.click()
    assert curves(page) == everything - 1
    assert names.first.get_attribute("aria-pressed") == "false"
    names.first.click()
    assert curves(page) == everything
    names.nth(1).click(modifiers=["Shift"])
    assert curves(page) == 1
    page.locator(f"{CHART} .names > :last-child").click()
    assert curves(page) == everything


def test_a_chart_is_read_with_the_pointer_and_with_keys(page):
    tip, plot = page.locator(f"{CHART} .tip"), page.locator(f"{CHART} .plot")
    assert tip.is_hidden()
    plot.hover(position=along(page, f"{CHART} .plot", 0.7))
    told = tip.text_content()
    for curve in page.evaluate("DATA.charts[0].curves"):
        assert curve["name"] in told
    plot.press("ArrowRight")
    before = tip.locator("b").first.text_content()
    for _ in range(3):
        plot.press("ArrowRight")
    now = tip.locator("b").first.text_content()
    assert now != before
    assert page.locator(f"{CHART} .unseen").text_content().startswith(now)


def test_the_trial_plays_pauses_and_is_stepped_through(page):
    captions = page.evaluate("DATA.trials[0].captions")
    stage, play = page.locator(".stage"), page.locator(".controls .main")
    assert step(page) == 0
    play.click()
    plays_to(page, 3)
    play.click()
    assert play.text_content() == "Play"
    page.locator(".stage .lab").click()
    at = step(page)
    stage.press("ArrowRight")
    assert step(page) == at + 1
    assert page.locator(".caption").text_content() == f"{captions[at + 1]}."
    stage.press("ArrowLeft")
    assert step(page) == at
    stage.press("Space")
    plays_to(page, at + 2)
    stage.press("Space")
    page.locator(".timeline").click(position=along(page, ".timeline", 0.995))
    assert step(page) == len(captions) - 1


def test_a_moment_and_another_visit_are_chosen(page):
    moments = page.evaluate("DATA.trials[0].moments")
    page.locator(".moments li:last-child button").click()
    assert step(page) == moments[-1][0]
    page.locator("#visit").select_option(index=1)
    assert page.locator(".about").text_content().startswith(page.evaluate("DATA.trials[1].cell"))
    assert step(page) == 0


def test_the_drawing_is_where_the_log_says(page, tiny_run):
    for _ in range(7):
        page.locator(".stage").press("ArrowRight")
    cell, number = page.evaluate("DATA.trials[0].cell"), page.evaluate("DATA.trials[0].trial")
    steps = read_trial(tiny_run / cell / "steps.mcap", number)
    for who in ("robot", "human"):
        place = f"translate({steps[f'{who}_col'][7] + 0.5:.3f},{steps[f'{who}_row'][7] + 0.5:.3f})"
        assert page.locator(f".lab g.{who}").get_attribute("transform").startswith(place)
    room, goal = int(steps["goal_room"][7]), page.locator(".lab .goal")
    assert [float(goal.get_attribute(name)) for name in ("x", "y")] == [room % 3 * 8, room // 3 * 8]


@pytest.mark.slow
def test_every_control_is_reached_by_the_tab_key(page):
    wanted = page.locator("button, select, input, summary, .plot, .stage").count()
    reached = set()
    for _ in range(wanted + 60):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("[...document.querySelectorAll('*')].indexOf(document.activeElement)"))
    for selector in (
        ".plot",
        ".stage",
        ".sort",
        "#choose select",
        ".controls .main",
        "#visit",
        ".rail input",
        "summary",
        "#theme",
        ".name",
    ):
        place = f"[...document.querySelectorAll('*')].indexOf(document.querySelector({selector!r}))"
        assert page.evaluate(place) in reached


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_light_and_dark_can_be_read(shown, tiny_page, scheme):
    page = shown(tiny_page, color_scheme=scheme)
    background = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert page.evaluate(CONTRASTS) == {}
    page.locator("#theme").click()
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") != background
    assert page.evaluate(CONTRASTS) == {}
    assert complaints(page) == []


@pytest.mark.slow
def test_on_a_phone_nothing_is_wider_than_the_screen(shown, tiny_page):
    page = shown(tiny_page, **PHONE)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    for control in page.locator("button:visible, select:visible").all():
        assert control.bounding_box()["height"] >= 36
    page.locator(".controls .main").tap()
    plays_to(page, 1)
    assert complaints(page) == []


@pytest.mark.slow
@pytest.mark.parametrize("width", [390, 800, 1280])
def test_a_grid_of_long_names_can_be_read(shown, grid_page, width):
    page = shown(grid_page, viewport={"width": width, "height": 900}, color_scheme="dark")
    while page.get_by_role("button", name="Show all").count():
        page.get_by_role("button", name="Show all").first.click()
    assert page.locator("#results tbody tr:not(.group):visible").count() > 50
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert page.evaluate(BROKEN_NUMBERS) == []
    assert page.evaluate(OVERLAPS) == []
    assert all(each.bounding_box()["height"] <= 240 for each in page.locator(".names").all())
    names = page.locator(".names").last
    assert names.locator(".name[aria-pressed=true]").count() == 8
    names.get_by_role("button", name="All").click()
    page.locator(".plot").last.hover()
    assert page.locator(".plot").last.locator(".tip > span").count() == 10
    assert complaints(page) == []


def test_what_the_human_sees_ends_at_the_lab(shown, tiny_run, tmp_path):
    report = gather(tiny_run)
    scene = report.trials[0]["scene"]
    for role, shape in (("human", [12.5, 0.5, 2, 1]), ("sight", [12.5, 0.5, 2, 5]), ("robot", [12.5, 20.5, 2, 1])):
        scene[role] = [shape] * len(scene[role])
    file = tmp_path / "corner.html"
    file.write_text(render(*report))
    page = shown(file)
    page.locator(".lab").scroll_into_view_if_needed()
    under = """([x, y]) => {
      const at = new DOMPoint(x, y).matrixTransform(document.querySelector(".lab").getScreenCTM());
      return document.elementsFromPoint(at.x, at.y).map((node) => node.getAttribute("class"));
    }"""
    assert "sees" in page.evaluate(under, [13.5, 0.45])
    assert "faces" not in page.evaluate(under, [12.5, -0.2])
    assert "drawn up to 5 cells; sight goes on" in page.locator(".legend").text_content()


def test_between_walls_the_cells_that_are_seen_are_drawn_and_shut_doors(shown, tiny_run, tmp_path):
    report = gather(tiny_run)
    trial = report.trials[0]
    scene, place = trial["scene"], trial["place"]
    for role in ("human", "sight"):
        scene[role] = [[12.5, 12.5, 2, 1 + 4 * (role == "sight")]] * len(scene[role])
    scene |= {"cells": [0] * len(scene["sight"]), "seen": [[[[12, 9, 1]], [[12, 11, 2]]]]}
    place |= {"shut": [[[20, 4], [22, 4]]], "closed": ["BE"], "open": [[[2, 4], [4, 4]]]}
    place["rooms"] = [[*room[:5], False, "x"] for room in place["rooms"]]
    file = tmp_path / "walls.html"
    file.write_text(render(*report))
    page = shown(file)
    sees, faces = (page.locator(f".lab .{field}").get_attribute("d") for field in ("sees", "faces"))
    assert (sees, faces) == ("M12,9h1v1h-1zM12,11h2v1h-2z", "M12,11h2v1h-2z")
    assert page.locator(".lab .sees").evaluate("(node) => node.parentNode.getAttribute('transform')") is None
    assert page.locator(".lab .shut").get_attribute("points") == "20,4 22,4"
    assert page.locator(".lab .open").count() == 1
    assert page.locator(".lab rect.wall").count() == 1, "the border of the lab"
    assert {name.text_content() for name in page.locator(".lab .room").all()} == {"x"}
    assert "doors shut: BE" in page.locator(".about").text_content()
    assert "shut door" in page.locator(".legend").text_content()
    assert complaints(page) == []


def shown_lines(page, section):
    return page.locator(f"#{section} tr[data-line]:visible")


def choose(page, head, value):
    page.locator("#choose").get_by_role("combobox", name=head, exact=True).select_option(label=value)


def test_what_is_chosen_is_shown_in_all_tables_and_charts(page):
    everything = shown_lines(page, "results").count()
    choose(page, "Agent", "rmax")
    rows = shown_lines(page, "results")
    assert 0 < rows.count() < everything
    assert {row.locator("th").text_content() for row in rows.all()} == {"rmax"}
    assert page.locator("#results [role=status]").text_content() == f"{rows.count()} lines, chosen of {everything}"
    assert "Agent rmax" in page.locator("#choose summary").text_content()
    assert page.locator(".chart:visible .name:visible").all_text_contents() == ["rmax"] * 3
    choose(page, "Task", "navigation")
    assert shown_lines(page, "results").count() == 1
    assert page.locator(".chart:visible").count() == 1
    page.get_by_role("button", name="Reset").click()
    assert shown_lines(page, "results").count() == everything
    choose(page, "Module", "navigation/rmax")
    assert page.locator("#results tbody:visible .group").all_text_contents() == [
        "navigation reward a trial",
        "visit goals a trial",
    ]


def means(page):
    rows = page.locator("#results tbody:visible").first.locator("tr[data-line]:visible")
    return [float(row.locator("td[data-label=Mean]").text_content()) for row in rows.all()]


def test_lines_are_sorted_within_their_experiment(page):
    declared = means(page)
    head = page.locator("#results thead").get_by_role("button", name="Mean")
    head.click()
    assert means(page) == sorted(declared) != declared
    assert page.locator("#results th[aria-sort]").get_attribute("aria-sort") == "ascending"
    head.press("Enter")
    assert means(page) == sorted(declared, reverse=True)


@pytest.mark.slow
def test_on_a_phone_lines_are_sorted_by_a_list(shown, tiny_page):
    page = shown(tiny_page, **PHONE)
    declared = means(page)
    page.locator("#results").get_by_role("combobox", name="Sort by").select_option(label="Mean")
    page.locator("#results").get_by_role("button", name="Ascending").tap()
    assert means(page) == sorted(declared, reverse=True)


@pytest.mark.slow
def test_a_long_table_is_shown_in_part_and_printed_whole(shown, grid_page):
    page = shown(grid_page)
    rows = shown_lines(page, "results")
    assert rows.count() == 25
    page.emulate_media(media="print")
    assert rows.count() > 50
    page.emulate_media(media="screen")
    page.locator("#results").get_by_role("button", name="Show all").click()
    assert rows.count() == page.locator("#results tr[data-line]").count() > 50


def test_without_a_script_every_line_can_be_read(browser, grid_page):
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(grid_page.absolute().as_uri())
    assert page.locator("tr[data-line]:visible").count() == page.locator("tr[data-line]").count() > 50
    context.close()


def test_an_agent_has_one_colour_on_the_whole_page(page):
    colours = page.evaluate("""
      DATA.charts.flatMap((chart, n) => chart.curves.map(({ line }, i) => {
        const agent = CHOICES.values[3][CHOICES.lines[line][3][0]];
        const spot = document.querySelectorAll(`[data-chart='${n}'] .name`)[i].querySelector(".spot");
        const cell = [...document.querySelectorAll("#results .agent")].find((each) => each.textContent === agent);
        return [agent, getComputedStyle(spot).getPropertyValue("--hue"), spot.getAttribute("d"),
          getComputedStyle(cell.querySelector("i")).getPropertyValue("--hue")];
      }))""")
    assert len({agent for agent, *_ in colours}) > 4
    assert len({tuple(each) for each in colours}) == len({agent for agent, *_ in colours})
    assert len({hue for _, hue, *_ in colours}) == len({agent for agent, *_ in colours})
    assert all(hue == beside for _, hue, _, beside in colours)


def test_copy_takes_the_command(page):
    button = page.locator("[data-copy='command']")
    button.click()
    page.wait_for_timeout(200)
    assert button.text_content() in ("Copied", "Selected")


def test_an_attack_in_every_name_does_nothing(shown, tiny_run, tmp_path):
    file = tmp_path / "hostile.html"
    file.write_text(render(*hostile(gather(tiny_run))))
    page = shown(file)
    page.locator(".plot").first.hover()
    page.locator(".moment").first.click()
    assert page.locator("img").count() == 0
    assert page.locator("script").count() == 2
    assert page.title() != "hurt"  # though the title holds the run's name
    assert complaints(page) == []
