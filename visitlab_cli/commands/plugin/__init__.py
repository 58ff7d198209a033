"""`visitlab plugin`: for whoever writes a kind of agent."""

from visitlab_cli.console.help import Help

HELP = Help("Configure", place=6, summary="Begin a package with an agent of your own, and check it.")
