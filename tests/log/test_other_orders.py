"""Logs whose messages another writer left in another order, or with values that no simulation has."""

import random

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

from visitlab_cli.errors import NotFoundError, RunError
from visitlab_cli.log.reader import check_values, read_trial
from visitlab_cli.world.lab import paper_lab

from .blocks import message_class


def rewritten(source, target, order, change=None):
    """The log `source` written by the stock writer: its messages in the order that `order` gives them."""
    with source.open("rb") as file:
        reader = make_reader(file)
        messages = list(reader.iter_messages(log_time_order=False))
    with target.open("wb") as stream:
        writer = Writer(stream, chunk_size=20_000)
        writer.start()
        channels = {}
        for schema, channel, _ in messages:
            if channel.topic not in channels:
                number = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.topic] = writer.register_channel(channel.topic, channel.message_encoding, number)
        for _, channel, message in order(messages):
            data = message.data if change is None else change(channel.topic, message.data)
            writer.add_message(channels[channel.topic], message.log_time, data, message.publish_time)
        writer.finish()


def trials_first(messages):
    return sorted(messages, key=lambda each: each[1].topic != "/trial")


def backwards(messages):
    return messages[::-1]


def shuffled(messages):
    return random.Random(1).sample(messages, len(messages))


@pytest.mark.parametrize("order", [trials_first, backwards, shuffled])
def test_a_trial_is_whole_in_whatever_order_another_writer_leaves_it(tiny_run, tmp_path, order):
    source = tiny_run / "social" / "script" / "fast" / "seed-0000" / "steps.mcap"
    rewritten(source, tmp_path / "other.mcap", order)
    for trial in (0, 7, 59):
        expected, found = read_trial(source, trial), read_trial(tmp_path / "other.mcap", trial)
        assert all(np.array_equal(expected[name], found[name]) for name in expected)
    with pytest.raises(NotFoundError, match="trial 60 is not recorded; the log holds 0 to 59"):
        read_trial(tmp_path / "other.mcap", 60)


def test_values_that_there_are_not_are_one_line(tiny_run, tmp_path):
    def strange(topic, data):
        if topic != "/step":
            return data
        step = message_class("Step").FromString(data)
        if step.trial == 2 and step.step == 5:
            step.goal_room = 77
        return step.SerializeToString()

    source = tiny_run / "visit" / "fast" / "seed-0000" / "steps.mcap"
    rewritten(source, tmp_path / "strange.mcap", list, strange)
    check_values(source, read_trial(tmp_path / "strange.mcap", 1), "visit", paper_lab())
    with pytest.raises(RunError, match="step 5 of trial 2 has goal_room 77, which there is not"):
        check_values(source, read_trial(tmp_path / "strange.mcap", 2), "visit", paper_lab())
