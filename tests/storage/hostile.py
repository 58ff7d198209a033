"""Files of a run as somebody hostile, or a bad disk, would leave them: with right hashes, where they have any."""

import hashlib
import io
import json
import zipfile

import numpy as np
import pyarrow
from pyarrow import parquet

from visitlab_cli.storage.cell_folder import to_json


def restate(cell):
    """Let `cell.json` state the sizes and hashes that the files have."""
    facts = json.loads((cell / "cell.json").read_text())
    for name in facts["files"]:
        content = (cell / name).read_bytes()
        facts["files"][name] = {"size": len(content), "sha256": hashlib.sha256(content).hexdigest()}
    (cell / "cell.json").write_text(to_json(facts))


def with_arrays(**changes):
    """A model with some arrays changed by functions; None drops one."""

    def change(content):
        arrays = dict(np.load(io.BytesIO(content)))
        for name, make in changes.items():
            if make is None:
                del arrays[name]
            else:
                arrays[name] = make(arrays.get(name))
        target = io.BytesIO()
        np.savez_compressed(target, **arrays)
        return target.getvalue()

    return change


def put(place, value):
    """Set one element of an array, negative places from the end."""

    def change(array):
        array = array.copy()
        array.flat[place] = value
        return array

    return change


def with_member(name, data, method=zipfile.ZIP_DEFLATED, mode="a"):
    """An archive with another member, or of it alone."""

    def change(content):
        target = io.BytesIO(content if mode == "a" else b"")
        with zipfile.ZipFile(target, mode) as archive:
            archive.writestr(zipfile.ZipInfo(name), data, method)
        return target.getvalue()

    return change


def header(text, data=b""):
    """The bytes of an `.npy` with this header."""
    text = text.encode().ljust(117) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + data


MODELS = {
    "nan": with_arrays(q=put(0, np.nan)),
    "infinity": with_arrays(q=put(-1, np.inf)),
    "too large": with_arrays(q=put(3, 1e200)),
    "shape": with_arrays(q=lambda q: q[:-1]),
    "transposed": with_arrays(q=lambda q: np.asfortranarray(q)),
    "flat": with_arrays(q=np.ravel),
    "dtype": with_arrays(q=lambda q: q.astype("f4")),
    "byte order": with_arrays(q=lambda q: q.astype(">f8")),
    "text": with_arrays(q=lambda q: np.array([["a"]])),
    "complex": with_arrays(q=lambda q: q.astype(complex)),
    "record": with_arrays(q=lambda q: np.zeros(q.shape, [("a", "f8")])),
    "pickle": with_arrays(q=lambda q: np.array([{}], dtype=object)),
    "no q": with_arrays(q=None),
    "no random state": with_arrays(random_state=None),
    "random state of zeros": with_arrays(random_state=np.zeros_like),
    "random state short": with_arrays(random_state=lambda state: state[:3]),
    "negative visits": with_arrays(visits=put(0, -1)),
    "negative sum": with_arrays(reward_sums=put(0, -np.inf)),
    "offsets past the end": with_arrays(successor_offsets=put(-1, 2**40)),
    "offset negative": with_arrays(successor_offsets=put(1, -5)),
    "offsets begin later": with_arrays(successor_offsets=put(0, 1)),
    "offsets decrease": with_arrays(successor_offsets=lambda offsets: np.concatenate([offsets[:1], offsets[:0:-1]])),
    "offsets short": with_arrays(successor_offsets=lambda offsets: offsets[:-1]),
    "state outside": with_arrays(successor_states=put(0, 2**31 - 1)),
    "state negative": with_arrays(successor_states=put(0, -1)),
    "fewer states": with_arrays(successor_states=lambda states: states[:-1]),
    "count of zero": with_arrays(successor_counts=put(0, 0)),
    "counts beside visits": with_arrays(successor_counts=lambda counts: counts + 1),
    "not a zip": lambda content: b"garbage" * 100,
    "cut": lambda content: content[:-30],
    "before it": lambda content: b"#!/bin/sh\n" + content,
    "twice": with_member("q.npy", b""),
    "climbing": with_member("../../q.npy", b""),
    "a thousand members": lambda content: content[:-22] + content[-22:-14] + b"\xe8\x03\xe8\x03" + content[-10:],
    "lzma": with_member("q.npy", header("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1), }"), 14, "w"),
    "claims 8 TB": with_member(
        "q.npy", header("{'descr': '<f8', 'fortran_order': False, 'shape': (1000000, 1000000), }"), mode="w"
    ),
    "code as header": with_member("q.npy", header("__import__('os').abort()"), mode="w"),
    "deep header": with_member("q.npy", header("(" * 110), mode="w"),
    "bomb": with_member("q.npy", bytes(2**29), mode="w"),
    "deflate damaged": lambda content: content[:90] + bytes([content[90] ^ 4]) + content[91:],
}


def table(compression="snappy", **columns):
    """A table of trials as pyarrow writes it."""
    target = io.BytesIO()
    parquet.write_table(pyarrow.table(columns), target, compression=compression)
    return target.getvalue()


def with_rewards(change, trial=lambda numbers: numbers, **options):
    """The table with other rewards, or other numbers of trials."""

    def make(content):
        columns = {name: values.to_numpy().copy() for name, values in zip(*_columns(content), strict=True)}
        columns = columns | {"trial": trial(columns["trial"]), "reward": change(columns["reward"])}
        return table(**options, **columns)

    return make


def _columns(content):
    read = parquet.read_table(io.BytesIO(content))
    return read.column_names, read.columns


def with_footer(change):
    """The table with its footer's bytes changed, and their length stated."""

    def make(content):
        size = int.from_bytes(content[-8:-4], "little")
        footer = change(content[-8 - size : -8])
        return content[: -8 - size] + footer + len(footer).to_bytes(4, "little") + b"PAR1"

    return make


TRIALS = {
    "nan": with_rewards(lambda rewards: rewards * np.nan),
    "infinity": with_rewards(lambda rewards: rewards + np.inf),
    "fewer": with_rewards(lambda rewards: rewards[:-1], lambda numbers: numbers[:-1]),
    "numbers": with_rewards(lambda rewards: rewards, lambda numbers: numbers[::-1].copy()),
    "texts": with_rewards(lambda rewards: rewards.astype(str)),
    "whole numbers": with_rewards(lambda rewards: rewards.astype(int)),
    "nulls": with_rewards(lambda rewards: pyarrow.array([None] * len(rewards), pyarrow.float64())),
    "nested": with_rewards(lambda rewards: pyarrow.array([[1.0]] * len(rewards))),
    "zstd": with_rewards(lambda rewards: rewards, compression="zstd"),
    "no rows": lambda content: table(trial=pyarrow.array([], pyarrow.int32()), reward=pyarrow.array([], "f8")),
    "other columns": lambda content: table(a=[1], b=[2.0]),
    "forty million rows": lambda content: table(
        trial=pyarrow.array(np.zeros(40_000_000, np.int32)), reward=pyarrow.array(np.zeros(40_000_000))
    ),
    "ten thousand columns": lambda content: table(**{f"c{number}": [1.0] for number in range(10_000)}),
    "not Parquet": lambda content: b"garbage" * 100,
    "emptied": lambda content: b"",
    "magic alone": lambda content: b"PAR1\0\0\0\0PAR1",
    "footer of zeros": with_footer(lambda footer: bytes(len(footer))),
    "footer of ones": with_footer(lambda footer: b"\xff" * len(footer)),
    "footer nested": with_footer(lambda footer: b"\x1c" * 5000),
    "footer of lists": with_footer(lambda footer: b"\x19" + b"\xf9\xff\xff\xff\xff\x0f" * 200),
    "footer cut": with_footer(lambda footer: footer[: len(footer) // 2]),
    "footer longer than the file": lambda content: content[:-8] + b"\xff\xff\xff\x7fPAR1",
    "pages of zeros": lambda content: b"PAR1" + bytes(400) + content[404:],
    "pages of ones": lambda content: b"PAR1" + b"\xff" * 100 + content[104:],
}

DEEP = "[" * 900 + "]" * 900
VALUES = {
    "nan": "NaN",
    "infinity": "1e999",
    "4,000 digits": "9" * 4000,
    "5,000 digits": "9" * 5000,
    "deep": DEEP,
    "very deep": "[" * 100_000,
    "half a character": '"\\ud800"',
    "a truth": "true",
    "nothing": "null",
    "text": '"x"',
    "list": "[[]]",
}
"""Values in the place of any that is right."""
