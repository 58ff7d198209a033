"""The page as text: one file that asks the network for nothing and runs no script but its own."""

import base64
import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from visitlab_cli.colours import PALETTE
from visitlab_cli.origin import HTML
from visitlab_cli.report.choices import Choices
from visitlab_cli.report.curves import Chart
from visitlab_cli.report.differences import against_script, differences
from visitlab_cli.report.facts import Facts
from visitlab_cli.report.interactions import interactions
from visitlab_cli.report.marginal_table import marginal_means
from visitlab_cli.report.markup import Html, element
from visitlab_cli.report.results_table import results
from visitlab_cli.report.sections import charts, head, repeat, trial, what_was_run
from visitlab_cli.scene.colours import DESIRED, GOAL, HUMAN, LEVEL_COLOURS, ROBOT, SHUT, css
from visitlab_cli.scene.lab import CLOTH, FLAG_FOOT, POLE
from visitlab_cli.scene.scene import TRAIL_STEPS
from visitlab_cli.scene.sight import FACES_DEGREES, SEES_DEGREES
from visitlab_cli.scene.words import LEVEL_NAMES
from visitlab_cli.world.enums import DISTANCE_NAMES

HERE = Path(__file__).parent
STYLES = ("page.css", "tables.css", "parts.css")
SCRIPTS = ("page.js", "choose.js", "chart.js", "lab.js", "player.js")
SECTIONS = {
    "run": "What was run",
    "results": "Results",
    "marginal": "Marginal means",
    "script": "Learned against the script",
    "differences": "Agents compared",
    "interactions": "Interactions",
    "curves": "Learning curves",
    "trial": "Best trial",
}
_ESCAPES = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026"}


def render(facts: Facts, curves: Sequence[Chart], trials: Sequence[dict[str, Any]]) -> str:
    """The page of a run."""
    style, script = Html(palette() + joined(STYLES)), joined(SCRIPTS)
    choices = Choices(facts.lines)
    parts = {
        "run": what_was_run(facts, SECTIONS["run"]),
        "results": results(facts, choices, SECTIONS["results"]),
        "marginal": marginal_means(facts, choices, SECTIONS["marginal"]),
        "script": against_script(facts, choices, SECTIONS["script"]),
        "differences": differences(facts, choices, SECTIONS["differences"]),
        "interactions": interactions(facts, choices, SECTIONS["interactions"]),
        "curves": charts(curves, SECTIONS["curves"]),
        "trial": trial(facts, trials, SECTIONS["trial"]),
    }
    titles = {name: SECTIONS[name] for name, part in parts.items() if part is not None}
    data = {
        "charts": [chart.as_json() for chart in curves],
        "choices": choices.as_json(),
        "trials": list(trials),
        "story": _story(),
    }
    body = element(
        "body",
        element("a", "Skip to the results", class_="skip", href="#results"),
        head(facts, titles | {"repeat": "Repeat it"}),
        element(
            "main",
            parts["run"],
            element("div", id="choose"),
            *list(parts.values())[1:],
            repeat(facts),
        ),
        element("footer", "Written by visitlab report. This page asks the network for nothing."),
        _data(data),
        element("script", script),
    )
    return f'{HTML}<html lang="en">{header(facts.name, style, script)}{body}</html>\n'


def header(title: str, style: Html, script: Html) -> Html:
    """The head of a page that may load nothing, and run and look as nothing but what it has itself."""
    policy = (
        f"default-src 'none'; script-src '{_digest(script)}'; style-src '{_digest(style)}'; "
        "base-uri 'none'; form-action 'none'"
    )
    return element(
        "head",
        Html('<meta charset="utf-8">'),
        Html(f'<meta http-equiv="Content-Security-Policy" content="{policy}">'),
        Html('<meta name="viewport" content="width=device-width, initial-scale=1">'),
        Html('<meta name="color-scheme" content="light dark">'),
        element("title", f"{title} · visitlab"),
        element("style", style),
    )


def joined(names: Sequence[str]) -> Html:
    """Styles or scripts, by their files, one after the other."""
    return Html("".join((HERE / name).read_text(encoding="utf-8") for name in names))


def palette() -> str:
    """The colours of agents, for light and dark pages."""
    rules = [
        f".colour-{place} {{ --hue: light-dark({paint.light}, {paint.dark}); }}" for place, paint in enumerate(PALETTE)
    ]
    return "\n".join((*rules, ""))


def _digest(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _data(values: Any) -> Html:
    """Values for the script, in which nothing can end the element that holds them."""
    text = json.dumps(values, separators=(",", ":"), allow_nan=False)
    escaped = "".join(_ESCAPES.get(letter, letter) for letter in text)
    return element("script", Html(escaped), type="application/json", id="data")


def _story() -> dict[str, Any]:
    """The words and colours of trials."""
    return {
        "levels": list(zip(LEVEL_NAMES, map(css, LEVEL_COLOURS), strict=True)),
        "distances": DISTANCE_NAMES,
        "flag": {"cloth": CLOTH, "pole": POLE, "foot": FLAG_FOOT},
        "colours": {
            "robot": css(ROBOT),
            "human": css(HUMAN),
            "goal": css(GOAL),
            "desired": css(DESIRED),
            "shut": css(SHUT),
        },
        "sees": SEES_DEGREES,
        "faces": FACES_DEGREES,
        "trail": TRAIL_STEPS,
    }
