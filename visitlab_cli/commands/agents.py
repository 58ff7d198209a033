"""`visitlab agents`: the kinds of agents that are there, whose they are, and what they take."""

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import Json, Plugins

HELP = Help(
    "Configure",
    place=4,
    examples=("visitlab agents", "visitlab agents --json"),
)


def command(plugin: Plugins = None, as_json: Json = False) -> None:
    """List the kinds of agents: built-in ones, those of installed packages and of files that are named."""
    from visitlab_cli.console.kinds import tell_kinds

    tell_kinds("agents", as_json=as_json)
