"""`visitlab optimum`: what is possible at all in navigation and go_to_human, exactly."""

import math
from typing import Annotated

import typer

from visitlab_cli.commands.options import Json
from visitlab_cli.terminal import plain, tell_json, tell_text


def command(
    gamma: Annotated[float, typer.Option(min=0, max=0.999, help="Discount factor of the discounted values.")] = 0.9,
    as_json: Json = False,
) -> None:
    """Exact values: the best policy and random actions, means over random starts; nothing is simulated."""
    from visitlab_cli.analysis.exact_values import exact_values
    from visitlab_cli.errors import UsageError

    if math.isnan(gamma):
        raise UsageError("--gamma nan: must be a number")
    values = exact_values(gamma)
    if as_json:
        tell_json({"gamma": gamma, "values": [each._asdict() for each in values]})
        return
    rows = [["task", "success", "measure", "optimal", "random"]]
    rows += [
        [each.task, each.success or "-", each.measure, f"{each.optimal:.4f}", f"{each.random:.4f}"] for each in values
    ]
    tell_text(aligned(rows, words=3))


def aligned(rows: list[list[str]], words: int) -> str:
    """Rows as columns two spaces apart; the first `words` columns are words, to the left, the others numbers."""
    rows = [list(map(plain, row)) for row in rows]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if column < words else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )
