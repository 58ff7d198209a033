"""`visitlab plugin check`: does an agent keep what agents promise?"""

from typing import Annotated

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import Json, Plugins
from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import plain, tell, tell_json, tell_text, to_stderr

HELP = Help(
    "Configure",
    place=2,
    examples=(
        "visitlab plugin check q_learning alpha=0.1",
        "visitlab plugin check rmax",
    ),
)


def command(
    kind: Annotated[str, typer.Argument(metavar="KIND", help="The kind, as a config names it.")],
    parameters: Annotated[
        list[str] | None, typer.Argument(metavar="[KEY=VALUE]...", help="Its parameters, where not as by default.")
    ] = None,
    plugin: Plugins = None,
    as_json: Json = False,
) -> None:
    """Try an agent on small worlds: legal actions, the same twice, saved, resumed, frozen, and whether it learns.

    What failed is told with what was seen (exit code 4). The first call compiles, for some seconds.
    """
    from visitlab_cli.authoring.check import check
    from visitlab_cli.authoring.kinds import agent_of
    from visitlab_cli.errors import RunError

    agent = agent_of(kind, parameters or ())
    rows = [["task", "", "asked", "seen"]]
    with to_stderr():
        answers = list(check(agent))
    for answer in answers:
        rows.append([answer.task, "passed" if answer.passed else "FAILED", answer.asked, answer.seen])
    failed = [answer for answer in answers if not answer.passed]
    if as_json:
        tell_json({"kind": kind, "passed": not failed, "answers": [answer._asdict() for answer in answers]})
    else:
        tell_text(aligned([list(map(plain, row)) for row in rows], words=len(rows[0])))
        if not failed:
            tell(f"{kind}: passed")
    if failed:
        raise RunError(*(f"{kind}: {each.asked}, {each.task}: {each.seen}" for each in failed))
