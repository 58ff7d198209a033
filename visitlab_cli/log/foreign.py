"""Logs of other writers: messages decoded one by one, each with the schema of its own channel."""

import struct
from collections.abc import Iterator

from google.protobuf.message import DecodeError
from mcap.opcode import Opcode

from visitlab_cli.log.chunks import definition_in, records_in
from visitlab_cli.log.decoding import Decoded
from visitlab_cli.log.definitions import Definitions
from visitlab_cli.log.source import DamagedError

MESSAGE_HEAD = struct.Struct("<HIQQ")
"""Channel, sequence, log time and publish time, then what the message says."""


def decode(content: bytes, definitions: Definitions) -> Iterator[Decoded]:
    """The steps and trials in `content`, the records of a chunk; what the chunk defines is learnt.

    Raises:
        DamagedError: a record or message is invalid.
        RefusedError: a message is of an encoding that is not read.
    """
    for record in records_in(content):
        if record.opcode == Opcode.MESSAGE:
            data = record.body + MESSAGE_HEAD.size
            if data > record.end:
                raise DamagedError("a message is cut")
            channel, _, log_time, _ = MESSAGE_HEAD.unpack_from(content, record.body)
            kind = definitions.kind_of(channel)
            if kind is not None:
                message = kind.decoder()
                try:
                    message.ParseFromString(content[data : record.end])
                except DecodeError as error:
                    raise DamagedError(f"a message of {kind.topic} is damaged") from error
                yield Decoded(kind, log_time, message)
        elif (definition := definition_in(content, record)) is not None:
            definitions.learn(definition)
