"""The parts of the page that stand around its table, curves and animation."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from visitlab_cli.config.canonical import dump_yaml
from visitlab_cli.config.experiment import Experiment
from visitlab_cli.config.grid import value_in_words
from visitlab_cli.config.model import Config
from visitlab_cli.config.phases import PHASES
from visitlab_cli.report.curves import Chart
from visitlab_cli.report.facts import Facts, counted
from visitlab_cli.report.markup import Html, element
from visitlab_cli.report.names import breakable
from visitlab_cli.settings import as_yaml
from visitlab_cli.storage.cell_folder import SOURCES

WITHOUT_SCRIPT = "This part needs JavaScript."
TOLD = ("lab", "observe", "belief", "controller", "told", "learns", "navigation_model")
"""Settings of an experiment that are told where they are not as by default."""


def section(name: str, title: str, *content: str | None) -> Html:
    """A part of the page under its title."""
    heading = element("h2", title, id=f"{name}-title")
    return element("section", heading, *content, id=name, aria_labelledby=f"{name}-title")


def head(facts: Facts, titles: Mapping[str, str]) -> Html:
    """What is seen first: the run's name, its size, and the way to each part."""
    steps = sum(cell.steps for cell in facts.cells)
    config = facts.config
    told = [
        f"{facts.done:,} of {counted(len(facts.cells), 'cell')}",
        counted(config.seeds, "seed"),
        counted(len(config.experiments), "experiment"),
        f"{steps:,} steps",
    ]
    links = [element("a", title, href=f"#{name}") for name, title in titles.items()]
    missing = f"Incomplete: {counted(len(facts.cells) - facts.done, 'cell')} of {len(facts.cells):,} not run yet."
    return element(
        "header",
        element("div", element("p", "visit the lab", class_="eyebrow"), _theme_button(), class_="bar"),
        element("h1", facts.name),
        element("p", " · ".join(told), class_="facts"),
        None if facts.complete else element("p", missing, class_="warning"),
        element("nav", *links, aria_label="Parts of this page"),
    )


def _theme_button() -> Html:
    return element("button", "Dark", type="button", id="theme", class_="quiet", aria_label="Switch light and dark")


def what_was_run(facts: Facts, title: str) -> Html:
    """The experiments, each with its task, agents, humans and length."""
    heads = ("Experiment", "Agents", "Humans", "Length", "Cells")
    rows = [_experiment(facts, name, settings) for name, settings in facts.config.experiments.items()]
    table = element(
        "table",
        element("thead", element("tr", *(element("th", text, scope="col") for text in heads))),
        element("tbody", *rows),
        class_="stacked",
    )
    return section("run", title, table, _grid(facts.config))


def _experiment(facts: Facts, name: str, settings: Experiment) -> Html:
    if settings.assembled:
        agents = ["/".join(filter(None, start)) for start in settings.starts.values()]
        length = f"{counted(settings.n_trials, 'trial')} of {counted(settings.trial_steps, 'step')}"
    else:
        agents = [_agent(facts.config, each) for each in settings.trained]
        length = f"{counted(settings.n_steps, 'step')} in trials of {settings.trial_steps:,}"
    start = "" if settings.assembled else ", ".join("/".join(filter(None, each)) for each in settings.starts.values())
    about = "; ".join([settings.plays.about, *([f"goes on from {start}"] if start else []), *_settings_told(settings)])
    lines = [line for line in facts.summaries if line.group.experiment == name]
    cells = f"{sum(line.done for line in lines):,} of {sum(len(line.group.cells) for line in lines):,}"
    return element(
        "tr",
        element("th", breakable(name), element("small", breakable(about)), scope="row"),
        element("td", *_listed(agents), data_label="Modules" if settings.assembled else "Agents"),
        element("td", *_listed(settings.met or ["none"]), data_label="Humans"),
        element("td", length, data_label="Length"),
        element("td", cells, data_label="Cells"),
    )


def _settings_told(settings: Experiment) -> Iterator[str]:
    """What is said of it beside who plays, as a config says it: lab, controller, phases and the like."""
    plain = as_yaml(settings)
    for name in TOLD:
        field = type(settings).model_fields.get(name)
        if field is not None and getattr(settings, name) != field.default:
            yield f"{name}: {_inner(plain[name])}"
    for number, phase in enumerate(plain.get(PHASES, ()) if settings.phases else ()):
        said = [f"{key} {_inner(value)}" for key, value in phase.items()]
        yield f"phase {number}: {', '.join(said)}"


def _inner(value: Any) -> str:
    if isinstance(value, dict):
        return " ".join(f"{key} {_inner(each)}" for key, each in value.items())
    return ", ".join(map(str, value)) if isinstance(value, list | tuple) else value_in_words(value)


def _agent(config: Config, name: str) -> str:
    kind = config.agents[name].kind
    return name if name == kind else f"{name} ({kind})"


def _listed(words: Sequence[str]) -> list[Html]:
    return [element("span", breakable(word), class_="word") for word in words]


def _grid(config: Config) -> Html | None:
    """What varies over the grid, if anything does."""
    if not config.vary:
        return None
    varied = [f"{path}: {', '.join(map(value_in_words, values))}" for path, values in config.vary.items()]
    return element("p", "Varied: ", *_listed(varied))


def charts(curves: Sequence[Chart], title: str) -> Html:
    """Where the script draws the learning curves."""
    if not curves:
        return section("curves", title, element("p", "No cell is finished yet.", class_="note"))
    note = (
        "Mean reward a trial; above each chart stands how many trials a point is the mean of. Bands, for up to four "
        "curves, are 95% intervals of the mean over seeds (Student's t). An agent has one colour and marker on the "
        "whole page; dashes and shades tell its curves apart. Of many curves the first ones are drawn: press a name to "
        "switch it on and off, with Shift to see it alone. Point at a chart, or focus it and use the arrow keys, to "
        "read it."
    )
    frames = [
        element("figure", element("noscript", WITHOUT_SCRIPT), class_="chart", data_chart=number)
        for number in range(len(curves))
    ]
    return section("curves", title, element("p", note, class_="note"), element("div", *frames, class_="charts"))


def trial(facts: Facts, trials: Sequence[Mapping[str, Any]], title: str) -> Html:
    """Where the script plays the best trial, or why there is none."""
    if trials:
        note = "Of each visit the recorded trial in which the human reached the most goal rooms."
        player = element("div", element("noscript", WITHOUT_SCRIPT), id="player", class_="player")
        return section("trial", title, element("p", note, class_="note"), player)
    if not any(each.assembled for each in facts.config.experiments.values()):
        why = "This config has no visit."
    elif not facts.config.record.one_trial_in:
        why = "No steps were recorded (record.steps: none). A run with record.steps=every shows its best trial here."
    else:
        why = "No visit is finished yet."
    return section("trial", title, element("p", why, class_="note empty"))


def repeat(facts: Facts) -> Html:
    """The command, the config and the versions that give the same results again."""
    file = f"{facts.config.name}.yaml"
    command = f"visitlab run {file}"
    rows = [
        element("tr", element("th", name, scope="row"), element("td", " and ".join(versions)))
        for name, versions in sorted(facts.versions.items())
    ]
    return section(
        "repeat",
        "Repeat it",
        element("p", "Save the config as ", element("code", file), " and run"),
        element("div", element("pre", command, id="command"), _copy("command"), class_="code"),
        element("p", _what_comes_again(facts)),
        element("table", element("tbody", *rows), class_="versions", aria_label="Versions"),
        element(
            "details",
            element("summary", "Config"),
            element(
                "div",
                element("pre", dump_yaml(facts.config), id="config", tabindex=0),
                element("button", "Save", type="button", class_="quiet", data_save="config", data_file=file),
                _copy("config"),
                class_="code",
            ),
        ),
    )


def _what_comes_again(facts: Facts) -> str:
    if len(facts.versions.get(SOURCES, ())) > 1:
        return "Its cells were made by different code, so no single one makes all of it again; see the sources below."
    return f"With these versions every table, log and model of {facts.name} comes out again, byte by byte."


def _copy(what: str) -> Html:
    return element("button", "Copy", type="button", class_="quiet", data_copy=what)
