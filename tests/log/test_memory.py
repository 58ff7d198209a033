"""What no log has by its task: a human's memory, of any 64 bits; a log without it is as it was."""

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from visitlab_cli.log.log import open_log
from visitlab_cli.log.reader import iter_steps, read_steps, read_trial
from visitlab_cli.log.recovery.recovery import recover
from visitlab_cli.log.schema import message_descriptor
from visitlab_cli.world.columns import MEMORY

from .blocks import random_steps, record

NAME = "human_memory"


@pytest.fixture(scope="module")
def steps():
    return random_steps(500, 20)


@pytest.fixture(scope="module")
def log(steps, tmp_path_factory):
    return record(tmp_path_factory.mktemp("asked") / "a.mcap", "visit", *steps, parts=(MEMORY,))


def test_it_is_read_back_whole_by_trial_and_by_block(log, steps):
    columns, rows = steps
    assert columns.human_memory.min() < -(2**62)
    assert np.array_equal(read_steps(log)[NAME], columns.human_memory)
    assert np.array_equal(read_trial(log, 7)[NAME], columns.human_memory[7 * 21 : 8 * 21])
    assert sum(len(block[NAME]) for block in iter_steps(log)) == rows
    with open_log(log) as ours:
        assert ours.own_chunks  # read as one view, not message by message


def test_any_reader_reads_it(log, steps):
    columns, _ = steps
    with log.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        read = [step.human_memory for *_, step in reader.iter_decoded_messages(["/step"])]
    assert read == columns.human_memory.tolist()


def test_a_torn_log_keeps_it(log, steps, tmp_path):
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(log.read_bytes()[: log.stat().st_size * 2 // 3])
    recover(torn, tmp_path / "saved.mcap")
    saved = read_steps(tmp_path / "saved.mcap")[NAME]
    assert 0 < len(saved) < len(steps[0].human_memory)
    assert np.array_equal(saved, steps[0].human_memory[: len(saved)])


@pytest.mark.parametrize("task", ["visit", "social", "navigation"])
def test_without_it_a_log_knows_no_such_field(tmp_path, steps, task):
    path = record(tmp_path / "a.mcap", task, *steps)
    assert NAME.encode() not in path.read_bytes()
    assert NAME not in read_steps(path)


def test_a_field_keeps_its_number():
    everything, less = (
        {field.name: field.number for field in message_descriptor("Step", parts).field} for parts in ((MEMORY,), ())
    )
    assert everything.keys() - less.keys() == {NAME}
    assert less.items() < everything.items()
