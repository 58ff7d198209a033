"""What reading costs: a column, all columns, one trial, memory, recovery, against the stock reader.

    python -m benchmarks.reading [LOG]

LOG is a steps.mcap; without one navigation is simulated for 2,000,000 steps first.
"""

import argparse
import random
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from benchmarks.rows import Row, number, show
from visitlab_cli.log.reader import iter_steps, read_steps, read_trial, trials
from visitlab_cli.log.recovery.recovery import recover
from visitlab_cli.log.tables import to_arrow

STEPS = 2_000_000
CONFIG = f"""
name: long
agents: {{mf: {{kind: q_learning}}}}
experiments:
  navigation: {{task: navigation, agents: [mf], steps: {STEPS}, trial_steps: 20}}
"""
TRIALS_READ = 40
REPEATS = 3
STOCK_MESSAGES = 50_000
MEASURE_PEAK = """
import sys
from pathlib import Path
from visitlab_cli.log import reader

def peak():
    # ru_maxrss would tell of the parent process too
    return next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM"))

path, how = Path(sys.argv[1]), sys.argv[2]
before = peak()
if how == "in blocks":
    sum(float(block["reward"].sum()) for block in reader.iter_steps(path, ["reward"]))
elif how == "one column":
    reader.read_steps(path, ["reward"])
elif how == "all columns":
    reader.read_steps(path)
elif how == "one trial":
    reader.read_trial(path, 0)
print(peak() - before)
"""
WAYS = ("one trial", "in blocks", "one column", "all columns")


def simulated(folder: Path) -> Path:
    config = folder / "long.yaml"
    config.write_text(CONFIG)
    command = [sys.executable, "-m", "visitlab_cli", "train", config, "--out", folder, "--quiet"]
    subprocess.run(list(map(str, command)), check=True, stdout=subprocess.DEVNULL)
    return next(folder.glob("*/navigation/mf/seed-0000/steps.mcap"))


def least_seconds(call: Callable[[], object]) -> float:
    """The least wall time of a few repeats, everything included from opening the file on."""
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - start)
    return min(seconds)


def stock_seconds(path: Path) -> float:
    """Seconds a message of the stock reader with decoding."""
    with path.open("rb") as file:
        messages = make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages("/step")
        start = time.perf_counter()
        read = sum(1 for _ in islice(messages, STOCK_MESSAGES))
        return (time.perf_counter() - start) / read


def as_recording(path: Path, trial: int) -> bytes:
    """What `visitlab replay --save` writes, imports aside."""
    from visitlab_cli.replay.recording import record
    from visitlab_cli.scene.trial import load_trial

    return record(load_trial(path, trial))


def peak_mib(path: Path, how: str) -> float:
    """How far the memory of a process of its own rises while it reads."""
    command = [sys.executable, "-c", MEASURE_PEAK, str(path), how]
    return int(subprocess.run(command, check=True, capture_output=True, text=True).stdout) / 1024


def rows(log: Path | None = None) -> Iterator[Row]:
    """Reading `log`, or a log of its own."""
    with tempfile.TemporaryDirectory() as folder:
        path = log or simulated(Path(folder))
        table = trials(path)
        steps = len(read_steps(path, ["step"])["step"])
        stock = stock_seconds(path)
        calls: dict[str, Callable[[], object]] = {
            "one column": lambda: read_steps(path, ["reward"]),
            "one column, in blocks": lambda: sum(len(block["reward"]) for block in iter_steps(path, ["reward"])),
            "all columns": lambda: read_steps(path),
            "all columns as Arrow, named": lambda: to_arrow(read_steps(path), named=True),
        }
        beside = f"stock reader, decoded {number(1 / stock)}"
        for name, call in calls.items():
            seconds = least_seconds(call)
            yield Row(f"reading {name}", steps / seconds, "messages/s", beside, stock * steps / seconds)

        numbers = random.Random(0).sample(table["trial"].tolist(), min(TRIALS_READ, len(table["trial"])))
        each = sorted(1e3 * least_seconds(lambda number=number: read_trial(path, number)) for number in numbers)
        yield Row(f"reading one trial of {number(len(table['trial']))}", statistics.median(each), "ms")
        middle = int(numbers[len(numbers) // 2])
        yield Row(
            "one trial as a Rerun recording, start-up aside", least_seconds(lambda: as_recording(path, middle)), "s"
        )
        yield Row("the table of all trials", least_seconds(lambda: trials(path)), "s")

        if Path("/proc/self/status").exists():
            for how in WAYS:
                yield Row(f"memory that reading {how} takes", peak_mib(path, how), "MiB")

        broken, fixed = Path(folder) / "broken.mcap", Path(folder) / "fixed.mcap"
        broken.write_bytes(path.read_bytes()[:-1000])
        start = time.perf_counter()
        saved = recover(broken, fixed)
        yield Row("recovering a log that was cut", saved.steps / (time.perf_counter() - start), "messages/s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("log", nargs="?", type=Path, metavar="LOG", help="a steps.mcap of a run")
    show(rows(parser.parse_args().log))


if __name__ == "__main__":
    main()
