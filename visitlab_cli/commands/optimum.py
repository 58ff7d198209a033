"""`visitlab optimum`: what is possible at all in navigation, go_to_human and the social task, exactly."""

import math
from typing import Annotated

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import Json
from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import tell_json, tell_text

HELP = Help(
    "Look",
    place=6,
    examples=(
        "visitlab optimum",
        "visitlab optimum --gamma 0.95 --json",
    ),
)


def command(
    gamma: Annotated[float, typer.Option(min=0, max=0.999, help="Discount factor of the discounted values.")] = 0.9,
    as_json: Json = False,
) -> None:
    """Exact values: the best policy and random actions, means over random starts; nothing is simulated.

    Of the social task for who sees all, with the paper's four humans: computed once, in a minute or two, and kept.
    """
    from visitlab_cli.errors import UsageError
    from visitlab_cli.exact.values import exact_values

    if math.isnan(gamma):
        raise UsageError("--gamma nan: must be a number")
    values = exact_values(gamma)
    if as_json:
        tell_json({"gamma": gamma, "values": [each._asdict() for each in values]})
        return
    rows = [["task", "success", "human", "measure", "optimal", "random"]]
    rows += [
        [
            each.task,
            each.success or "-",
            each.human or "-",
            each.measure,
            *(f"{value:.{each.digits}f}" for value in (each.optimal, each.random)),
        ]
        for each in values
    ]
    tell_text(aligned(rows, words=4))
