"""`visitlab runs`: what lies in the folder of runs, and keeping it in order."""

from visitlab_cli.console.help import Help

HELP = Help("Runs", place=1, summary="List, show, watch, compare, check and remove runs.")
