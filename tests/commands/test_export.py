"""`visitlab export`: trials as Foxglove shows them, with the words of the replay; tables as CSV and Parquet."""

import json
from collections import Counter

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from tests.program import visitlab
from visitlab_cli.log.reader import read_trial
from visitlab_cli.scene.words import GESTURES, captions
from visitlab_cli.world.lab import paper_lab

CELL = "visit/fast/seed-0000"


def messages(path, topic):
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        return [decoded for *_, decoded in reader.iter_decoded_messages(topic)]


def test_a_trial_with_the_words_of_the_replay(tiny_run, tmp_path):
    done = visitlab("export", tiny_run, "--foxglove", "--trial", 1, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    name = "visit-fast-seed-0000-trial-1.foxglove.mcap"
    assert done.stdout == f"{CELL}, trial 1: {name}\n"
    steps = read_trial(tiny_run / CELL / "steps.mcap", 1)
    path = tmp_path / name
    told = [log.message for log in messages(path, "/caption")]
    assert told == [f"trial 1, step {row}: {caption}" for row, caption in enumerate(captions(steps, paper_lab()))]
    assert [step.state for step in messages(path, "/step")] == steps["state"].tolist()
    robots = [entity for scene in messages(path, "/scene") for entity in scene.entities if entity.id == "robot"]
    said = [[text.text for text in robot.texts] for robot in robots]
    assert said == [[GESTURES[action]] if action in GESTURES else [] for action in steps["executed_action"].tolist()]
    assert sum(map(len, said)) > 0


def test_several_trials_as_json(tiny_run, tmp_path):
    out = tmp_path / "x.mcap"
    choice = ["--trial", 2, "--trial", 0, "--trial", 2]
    done = visitlab("export", tiny_run / CELL / "steps.mcap", "--foxglove", *choice, "-o", out, "--json")
    told = json.loads(done.stdout)
    assert told["trials"] == [2, 0]  # each once
    assert (told["rows"], told["file"]) == (202, str(out))
    assert Counter(step.trial for step in messages(out, "/step")) == Counter({2: 101, 0: 101})
    assert len(messages(out, "/lab")) == 2


@pytest.mark.parametrize("task", ["navigation", "go_to_human", "social"])
def test_trainings_too(tiny_run, tmp_path, task):
    done = visitlab("export", tiny_run, "--foxglove", "-e", task, "-o", tmp_path / "x.mcap")
    assert done.returncode == 0, done.stderr
    assert len(messages(tmp_path / "x.mcap", "/scene")) == 21


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        ([], 2, "choose one format: --csv, --parquet, --foxglove, --minari or --ros2bag"),
        (["--foxglove", "--table", "steps"], 2, "--table: goes with --csv and --parquet only"),
        (["--foxglove", "--cell-size", "2"], 2, "--cell-size: goes with --ros2bag only"),
        (["--foxglove", "--trial", "99"], 5, "trial 99 is not recorded; the log holds 0 to 3"),
        (["--foxglove", "-o", "mine.mcap"], 2, "mine.mcap: exists; choose another file with -o"),
    ],
)
def test_what_does_not_work_is_one_line_and_writes_nothing(tiny_run, tmp_path, arguments, code, message):
    (tmp_path / "mine.mcap").write_text("mine")
    done = visitlab("export", tiny_run, *arguments, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (code, "")
    assert done.stderr.splitlines()[-1].endswith(message)
    assert [file.read_text() for file in tmp_path.iterdir()] == ["mine"]
