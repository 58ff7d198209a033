"""`visitlab steps`: the table of a trial says what the log says, in the words of the replay."""

import json
import re
import subprocess
import sys

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

from tests.program import visitlab
from visitlab_cli.errors import RunError
from visitlab_cli.log.reader import read_trial, trials
from visitlab_cli.log.tables import names_of
from visitlab_cli.replay.choice import CHOOSE
from visitlab_cli.scene.trial import load_trial
from visitlab_cli.scene.words import LEVEL_NAMES, captions, direction_name, room_name
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.tasks import TASK_NAMES

CELL = "visit/fast/seed-0000"


def test_a_line_for_each_step_in_the_words_of_the_replay(tiny_run):
    done = visitlab("steps", tiny_run, "--trial", 2)
    assert done.stderr == f"chose {CELL} of 3 cells; the next is visit/slow/seed-0000; {CHOOSE}\n"
    title, _, head, *rows = done.stdout.splitlines()
    assert title == f"{CELL}, trial 2"
    assert head.split() == ["step", "goal", "desired", "level", "reward", "what", "happens"]
    steps = read_trial(tiny_run / CELL / "steps.mcap", 2)
    assert len(rows) == 101
    for row, line in enumerate(rows):
        goal, desired = room_name(paper_lab(), steps["goal_room"][row]), direction_name(steps["desired_direction"][row])
        level = LEVEL_NAMES[steps["interaction_level"][row]]
        words = [str(row), goal, desired, level, f"{steps['reward'][row]:g}", captions(steps, paper_lab())[row]]
        assert line.split() == " ".join(words).split()
        assert line[head.index("what") :] == captions(steps, paper_lab())[row]


def test_json_has_the_values_with_their_names(tiny_run):
    done = visitlab("steps", tiny_run, "-e", "social", "--agent", "mb", "--human", "fast", "--seed", 0, "--json")
    told = json.loads(done.stdout)
    steps = read_trial(tiny_run / "social/mb/fast/seed-0000/steps.mcap", 0)
    assert (told["cell"], told["trial"]) == ("social/mb/fast/seed-0000", 0)
    assert [step.pop("caption") for step in told["steps"]] == captions(steps, paper_lab())
    for name, values in steps.items():
        expected = [names_of(name)[value] for value in values] if names_of(name) else values.tolist()
        assert [step[name] for step in told["steps"]] == expected


@pytest.mark.parametrize("task", TASK_NAMES)
def test_a_log_that_says_it_is_of_another_task_is_shown_or_refused_in_a_line(tiny_run, tmp_path, task):
    refused = {}
    for path in ("navigation/mf", "go_to_human/mb", "social/mb/fast", "visit/fast"):
        with (tiny_run / path / "seed-0000" / "steps.mcap").open("rb") as file:
            reader = make_reader(file)
            (about,) = [each.metadata for each in reader.iter_metadata()]
            messages = list(reader.iter_messages(log_time_order=False))
        with (tmp_path / "a.mcap").open("wb") as stream:
            writer = Writer(stream)
            writer.start()
            writer.add_metadata("visitlab", about | {"task": task})
            channels = {
                schema.name: writer.register_channel(
                    channel.topic,
                    channel.message_encoding,
                    writer.register_schema(schema.name, schema.encoding, schema.data),
                )
                for schema, channel in {channel.topic: (schema, channel) for schema, channel, _ in messages}.values()
            }
            for schema, _, message in messages:
                writer.add_message(channels[schema.name], message.log_time, message.data, message.publish_time)
            writer.finish()
        try:
            for number in trials(tmp_path / "a.mcap")["trial"].tolist():
                trial = load_trial(tmp_path / "a.mcap", number)
                captions(trial.steps, trial.lab)
        except RunError as error:
            refused[path.split("/")[0]] = str(error)
    assert task not in refused
    assert refused.keys() >= ({"social", "visit"} if task in ("navigation", "go_to_human") else set())
    line = re.compile(r"/\S+/a.mcap: step \d+ of trial \d+ has .+, which there is not.*")
    assert all(map(line.fullmatch, refused.values())), refused


@pytest.mark.parametrize(
    ("selection", "cell", "columns"),
    [
        (["-e", "navigation", "--agent", "mf"], "navigation/mf/seed-0000", ["step", "goal", "reward"]),
        (["-e", "go_to_human", "--agent", "mb"], "go_to_human/mb/seed-0000", ["step", "level", "reward"]),
        (["-e", "social", "--agent", "script"], "social/script/fast/seed-0000", ["step", "desired", "level", "reward"]),
    ],
)
def test_a_training_trial_has_what_its_task_has(tiny_run, selection, cell, columns):
    done = visitlab("steps", tiny_run, *selection, "--trial", "best")
    title, _, head, *rows = done.stdout.splitlines()
    assert title.startswith(f"{cell}, trial ")
    assert head.split()[:-2] == columns
    assert len(rows) == 21


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["--trial", "4"], 5, "trial 4 is not recorded; the log holds 0 to 3"),
        (["--trial", "bset"], 2, "--trial bset: must be a number or one of best, worst"),
        (["--human", "fats"], 5, "no human fats; did you mean fast?"),
    ],
)
def test_what_is_not_there_is_one_line(tiny_run, arguments, code, message):
    done = visitlab("steps", tiny_run, *arguments)
    assert done.returncode == code
    assert done.stdout == ""
    assert message in done.stderr.splitlines()[-1]
    assert "Traceback" not in done.stderr


def test_a_file_and_a_closed_pipe(tiny_run):
    log = tiny_run / CELL / "steps.mcap"
    command = f'"{sys.executable}" -m visitlab_cli steps "{log}" --json | head -n 1'
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
    assert done.stdout == "{\n"
    assert "Traceback" not in done.stderr
