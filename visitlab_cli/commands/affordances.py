"""`visitlab affordances`: what the social module believes, beside what is true."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, At, Json, Out, Run
from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import tell, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.affordances.learned import Affordances, Graph
    from visitlab_cli.affordances.plain import Weight


HELP = Help(
    "Look",
    place=5,
    examples=(
        "visitlab affordances quickstart",
        "visitlab affordances quickstart --experiment social --json",
    ),
)


def command(
    run: Run,
    experiment: Annotated[
        str,
        typer.Option(
            "--experiment", "-e", help="Of this training; else the visits'.", autocompletion=completion.experiments
        ),
    ] = "",
    agent: Annotated[str, typer.Option(help="Of this agent.", autocompletion=completion.agents)] = "",
    human: Annotated[str, typer.Option(help="Trained with this human.", autocompletion=completion.humans)] = "",
    seed: Annotated[int, typer.Option(min=0, help="Of this repetition, from 0.")] = 0,
    at: At = None,
    picture: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw it, with how it adapts: a .svg, .png or .pdf."),
    ] = None,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """The learned Fig. 4: what the social module thinks that its actions do, beside what they do.

    --json has every action and level, and where it would go around the human.
    """
    from visitlab_cli.affordances.learned import affordances
    from visitlab_cli.affordances.plain import as_json as to_json
    from visitlab_cli.origin import check_ours
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.plan.selection import Selection
    from visitlab_cli.storage.run_folder import find_run, read_config

    if picture is not None:
        check_ours(picture)
    folder = find_run(run, out)
    found = affordances(folder, plan(read_config(folder)), Selection(experiment, human, agent, seed, tuple(at or ())))
    if picture is not None:
        from visitlab_cli.affordances.picture import save_affordances

        save_affordances(found, picture)
        tell_json({"run": str(folder), "file": str(picture)}, None) if as_json else tell(str(picture))
    elif as_json:
        tell_json({"run": str(folder), **to_json(found)})
    else:
        tell_text(_text(found))


def _text(found: "Affordances") -> str:
    lines = [f"{found.cell.path}, learned with {found.cell.human}", _table({"learned": found.knows}), ""]
    for each in found.adaptations:
        lines += [
            f"{each.cell.path}, after its visit to {each.cell.human}",
            _table({"before": found.knows, "after": each.knows, "in the visit": each.saw}),
            "",
        ]
    lines += [
        "Probability of the level next (visits behind it). True: by the human's parameters, at the visits in the",
        "column before; - where they alone do not decide it. NOT_ENGAGED: any of the levels 0 to 4.",
    ]
    return "\n".join(lines)


def _table(graphs: "dict[str, Graph]") -> str:
    from visitlab_cli.affordances.plain import ARROWS, OUTCOMES, weight

    rows = [["action", "level", "level next", *graphs, "true"]]
    for arrow in ARROWS:
        weights = [weight(graph, arrow) for graph in graphs.values()]
        learned = [f"{each.learned:.3f} ({each.visits:,})" if each.visits else "-" for each in weights]
        rows.append([str(arrow.kind), arrow.level.name, OUTCOMES[arrow.outcome], *learned, _true(weights[-1])])
    return aligned(rows, words=3)


def _true(weight: "Weight") -> str:
    if math.isnan(weight.low):
        return "-"
    low, high = f"{weight.low:.3f}", f"{weight.high:.3f}"
    return low if low == high else f"{low} to {high}"
