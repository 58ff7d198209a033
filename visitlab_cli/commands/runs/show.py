"""`visitlab runs show`: what a run reached, a line for each experiment, agent and human."""

import time
from typing import TYPE_CHECKING, Annotated

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.metrics import metrics_table
from visitlab_cli.console.options import FIRST_TRIALS, RUNS, First, Json, Out, Run
from visitlab_cli.console.phases import table_and_notes
from visitlab_cli.console.unread import tell_unread
from visitlab_cli.console.words import age_in_words, aligned, number, size_in_words
from visitlab_cli.terminal import plain, tell, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.results.runs import RunLine
    from visitlab_cli.results.summary import Summary
    from visitlab_cli.results.varying import Varying


HELP = Help(
    "Runs",
    place=2,
    examples=(
        "visitlab runs show quickstart",
        "visitlab runs show latest --level 0.5 --metrics",
    ),
)


def command(
    run: Run,
    level: Annotated[
        float, typer.Option(min=0, max=1, help="The part of the final value that counts as learned.")
    ] = 0.9,
    first: First = FIRST_TRIALS,
    metrics: Annotated[
        bool, typer.Option("--metrics", help="Also what the interactions were like, as visitlab metrics tells.")
    ] = False,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Show what a run reached: mean with 95% interval, median, seeds, steps to a level, seconds."""
    from visitlab_cli.config.canonical import config_hash
    from visitlab_cli.errors import UsageError
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.results.evaluated import evaluated
    from visitlab_cli.results.phases import phase_results
    from visitlab_cli.results.recorded import recorded_metrics
    from visitlab_cli.results.runs import run_line
    from visitlab_cli.results.summary import summaries
    from visitlab_cli.storage.made_by import made_by, mixed
    from visitlab_cli.storage.run_folder import edited, find_run, read_config

    if not level:
        raise UsageError(f"--level {level}: must be above 0, at most 1")
    folder = find_run(run, out)
    config = read_config(folder)
    if note := edited(folder, config_hash(config)):
        tell(note, err=True)
    cells = plan(config)
    if told := mixed(made_by(folder, (cell.path for cell in cells))):
        tell(f"{folder}: {told}", err=True)
    line = run_line(folder, config, cells)
    played = [cell for those in evaluated(folder, config).values() for cell in those]
    lines, phases = summaries(folder, [*cells, *played], level), phase_results(folder, cells, first)
    interactions = recorded_metrics(folder, [*cells, *played], first) if metrics else []
    tell_unread(folder, [*cells, *played])
    if as_json:
        whole = {"run": str(folder), **line.as_json(), "level": level, "results": [each.as_json() for each in lines]}
        whole |= {"first": first, "phases": [each.as_json() for each in phases]} if phases else {}
        tell_json(whole | ({"metrics": [row for each in interactions for row in each.as_rows()]} if metrics else {}))
        return
    parts = [_text(line, lines, level), *(["", *table_and_notes(phases, first)] if phases else [])]
    parts += ["", metrics_table(interactions)] if interactions else []
    tell_text("\n".join(parts))
    if metrics and not interactions:
        tell(f"{folder}: no finished cell with a human who can be engaged has a log, which metrics are of", err=True)


def _text(line: "RunLine", lines: "list[Summary]", level: float) -> str:
    from visitlab_cli.results.units import SHARED

    age = age_in_words(time.time() - line.changed)
    seeds = f"{line.seeds} seed{'s' if line.seeds != 1 else ''}"
    head = f"{line.run}: {line.state}, {line.done} of {line.cells} cells, {seeds}"
    frozen = " (frozen: of all)" if any(each.group.evaluation.frozen for each in lines) else ""
    notes = [
        "",
        f"Mean over n seeds of the last tenth of trials{frozen} ± half its 95% interval (Student's t); their median.",
        f"To {level:.0%}: median steps until a hundredth of the trials first has {level:.0%} of the mean.",
    ]
    if any(each.units.shared for each in lines):
        notes.append(SHARED)
    return "\n".join([f"{plain(head)}, {size_in_words(line.size)}, {age} old", "", _table(lines, level), *notes])


def _table(lines: "list[Summary]", level: float) -> str:
    from visitlab_cli.results.varying import varying

    evaluated = any(each.group.evaluation.folder for each in lines)
    who, rest = ["experiment", "agent", "human"], [*(["played"] if evaluated else []), "measure"]
    numbers = ["mean", "median", "n", f"steps to {level:.0%}", "seconds a cell"]
    varied = varying((each.group.point for each in lines), taken=[*who, *rest, *numbers])
    words = [*who, *varied.heads.values(), *rest]
    return aligned([[*words, *numbers], *(_row(each, varied, evaluated) for each in lines)], words=len(words))


def _row(each: "Summary", varied: "Varying", evaluated: bool) -> list[str]:
    group = each.group
    played = [group.evaluation.words if group.evaluation.folder else "-"] if evaluated else []
    return [
        *(group.experiment, group.agent, group.human or "-", *varied.values(group.point), *played, group.measure),
        each.value.in_words() if each.value else "-",
        number(each.median, ".2f"),
        each.units.words if each.units.shared else str(each.n),
        number(each.steps_to_level, ",.0f"),
        number(each.seconds, ".1f"),
    ]
