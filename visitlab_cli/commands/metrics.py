"""`visitlab metrics`: what the interactions of a run were like."""

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Agent, At, Experiment, First, Human, Json, Out, Run, Seed
from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import plain, tell_json, tell_text

HELP = Help(
    "Look",
    place=6,
    examples=(
        "visitlab metrics quickstart --experiment visit",
        "visitlab metrics latest --json",
    ),
)


def command(
    run: Run,
    experiment: Experiment = "",
    human: Human = "",
    agent: Agent = "",
    seed: Seed = None,
    at: At = None,
    first: First = 20,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Measure gaze, time to engagement, distance, attention lost and the way walked, from the logs."""
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.plan.selection import Selection
    from visitlab_cli.results.metrics import METRICS, WHOLE, group_metrics
    from visitlab_cli.results.varying import varying
    from visitlab_cli.storage.run_folder import find_run, read_config

    folder = find_run(run, out)
    cells = Selection(experiment, human, agent, seed, tuple(at or ())).of(folder, plan(read_config(folder)))
    found = group_metrics(folder, cells, first)
    if as_json:
        rows = [row for each in found for row in each.as_rows()]
        tell_json({"run": str(folder), "confidence": 0.95, "metrics": rows})
        return
    phased = any(each.part != WHOLE for each in found)
    who = ["experiment", "agent", *(["phase", "trials"] if phased else []), "human"]
    rest = ["metric", "unit"]
    varied = varying((each.group.point for each in found), taken=[*who, *rest])
    table = [[*who, *varied.heads.values(), *rest, "mean", "n"]]
    for each in found:
        group = each.group
        part = ["-" if value in (None, "") else str(value) for value in each.part] if phased else []
        names = [group.experiment, group.agent, *part, each.human, *varied.values(group.point)]
        for name, (estimate, units) in each.values.items():
            number = units.words if units.shared else str(units.n)
            table.append([*names, name, METRICS[name].unit, estimate.in_words(), number])
    tell_text(aligned([list(map(plain, row)) for row in table], words=len(table[0]) - 2))
