"""What an option names of a run that does not have it is not found, what can't be written a failure: in any command."""

import inspect

import pytest
from typer.testing import CliRunner

from tests.program import visitlab
from visitlab_cli.cli import app
from visitlab_cli.errors import NotFoundError

NAMES = ("experiment", "human", "agent", "at")
MORE = {"compare": ["--by", "agent"], "export": ["--csv"]}
COMMANDS = {command.name: command.callback for command in app.registered_commands}
COMMANDS |= {
    f"{group.name} {command.name}": command.callback
    for group in app.registered_groups
    for command in group.typer_instance.registered_commands
}
ASKING = [
    (words, name)
    for words, callback in COMMANDS.items()
    for name in NAMES
    if {"run", name} <= set(inspect.signature(callback).parameters)
]


def test_several_commands_name_what_a_run_has():
    assert {"affordances", "eval", "metrics", "steps"} <= {words for words, _ in ASKING}


@pytest.mark.parametrize(("words", "name"), ASKING)
def test_a_name_that_a_run_does_not_have_is_not_found(tiny_run, words, name):
    value = "agents.nobody.alpha=1" if name == "at" else "nobody"
    line = [*words.split(), str(tiny_run), *MORE.get(words, []), f"--{name}", value]
    with pytest.raises(NotFoundError, match="nobody"):
        CliRunner().invoke(app, line, catch_exceptions=False)


@pytest.mark.parametrize("ending", ["--csv", "--parquet", "--foxglove", "--minari", "--ros2bag"])
def test_where_nothing_can_be_written_is_a_failure(tiny_run, tmp_path, ending):
    (tmp_path / "file").touch()
    suffix = {"--csv": ".csv", "--parquet": ".parquet"}.get(ending, "")
    done = visitlab("export", tiny_run, ending, "-o", tmp_path / "file" / f"x{suffix}")
    assert (done.returncode, done.stdout) == (4, "")
    assert "can't be written" in done.stderr.splitlines()[-1]
