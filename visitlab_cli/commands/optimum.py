"""`visitlab optimum`: what is possible at all in navigation, go_to_human and the social task, exactly."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Json, Out
from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import tell, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.config.model import Config

HELP = Help(
    "Look",
    place=6,
    examples=(
        "visitlab optimum",
        "visitlab optimum beyond/labs --lab corridor",
    ),
)
PAPER = "paper"


def command(
    config: Annotated[
        str | None,
        typer.Argument(
            metavar="CONFIG|RUN",
            help="Of all labs and humans of this config, or run; else of the paper's.",
            autocompletion=completion.configs,
            show_default=False,
        ),
    ] = None,
    named: Annotated[
        list[str] | None, typer.Option("--lab", metavar="NAME", help="This lab alone, and no humans; may be repeated.")
    ] = None,
    gamma: Annotated[float, typer.Option(min=0, max=0.999, help="Discount factor of the discounted values.")] = 0.9,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Exact values: the best policy and random actions, means over random starts; nothing is simulated.

    Of navigation and go_to_human in each lab; of the social task for who sees all, with each human of the paper's
    kind: computed once, ten seconds a human or more, and kept. Of a visit none is known.
    """
    from visitlab_cli.config.labs import labs_of
    from visitlab_cli.errors import NotFoundError
    from visitlab_cli.exact.values import exact_values
    from visitlab_cli.wording import or_else, printable

    found = _config_of(config or PAPER, out)
    known = labs_of(found.labs)
    for name in named or ():
        if name not in known:
            raise NotFoundError(f"--lab {printable(name)}: no lab is called so{or_else(name, known)}")
    labs, humans = (dict.fromkeys(named), ()) if named else (known, found.humans)
    values, unknowns = exact_values(gamma, found, list(labs), list(humans))
    for line in unknowns:
        tell(f"not known: {line}", err=True)
    if as_json:
        tell_json({"gamma": gamma, "values": [each._asdict() for each in values], "unknown": unknowns})
        return
    where = [] if config is None else ["lab"]
    rows = [["task", *where, "success", "human", "measure", "optimal", "random"]]
    rows += [
        [
            each.task,
            *([each.lab or "-"] if where else []),
            each.success or "-",
            each.human or "-",
            each.measure,
            *(f"{value:.{each.digits}f}" for value in (each.optimal, each.random)),
        ]
        for each in values
    ]
    tell_text(aligned(rows, words=4 + len(where)))


def _config_of(word: str, out: Path) -> "Config":
    """A config by its file or shipped name, else that of a run."""
    from visitlab_cli.config.files import find
    from visitlab_cli.config.loading import load
    from visitlab_cli.errors import NotFoundError
    from visitlab_cli.storage.run_folder import find_run, read_config

    try:
        file = find(word)
    except NotFoundError as error:
        try:
            return read_config(find_run(word, out))
        except NotFoundError:
            raise error from None
    return load(file)
