"""`visitlab runs`: what lies in the folder of runs, and keeping it in order."""

import typer

from visitlab_cli.commands import runs_diff, runs_list, runs_prune, runs_rm, runs_show, runs_verify

app = typer.Typer(help="List, show, compare, check and remove runs.", no_args_is_help=True)
app.command("list")(runs_list.command)
app.command("show")(runs_show.command)
app.command("diff")(runs_diff.command)
app.command("verify")(runs_verify.command)
app.command("prune")(runs_prune.command)
app.command("rm")(runs_rm.command)
