"""`python -m tests.faults`: try every class of faults, print the table, end with 1 if anything was lost or wrong."""

import argparse
import resource
import signal
import sys
import time
from collections import defaultdict
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

from tests.faults import (  # noqa: F401  (they register)
    clusters,
    configs,
    contents_of_runs,
    disks,
    fuzzing,
    hostile_runs,
    interrupted,
    logs,
    places,
)
from tests.faults.bench import Bench
from tests.faults.fault import FAULTS, Fault, Try
from tests.faults.page import write_page

SHOWN = 5


@dataclass
class Counted:
    """What came of a class: the tries that hit, what was lost and wrong (each with how to do it again)."""

    fault: Fault
    tries: int = 0
    lost: list[str] = field(default_factory=list)
    wrong: list[str] = field(default_factory=list)
    seconds: float = 0.0
    not_tried: str = ""


def one(fault: Fault, index: int, seed: int, bench: Bench) -> Try:
    """One try; an exception of the tool itself is wrong, too."""
    this = Try(fault.name, index, seed, bench)
    begun = time.monotonic()
    try:
        fault.check(this)
    except Exception as error:
        this.wrong.append(f"the check itself failed: {type(error).__name__}: {error}")
    finally:
        bench.forget(this.folder)
    this.seconds = time.monotonic() - begun
    return this


def counted(chosen: Iterable[Fault], seed: int, bench: Bench, only: Sequence[int] | None, jobs: int) -> list[Counted]:
    """Try all of `chosen`, two at a time."""
    found: dict[str, Counted] = {fault.name: Counted(fault, not_tried=bench.missing(fault.needs)) for fault in chosen}
    work = [
        (each.fault, index)
        for each in found.values()
        if not each.not_tried
        for index in range(each.fault.fast if bench.fast else each.fault.tries)
        if only is None or index in only
    ]
    left = defaultdict(int)
    for fault, _ in work:
        left[fault.name] += 1
    with ThreadPoolExecutor(jobs) as pool:
        for this in pool.map(lambda each: one(*each, seed, bench), work):
            each = found[this.name]
            each.tries += this.count
            each.seconds += this.seconds
            again = f" (python -m tests.faults {this.name} --seed {seed} --index {this.index})"
            each.lost += [line + again for line in this.lost]
            each.wrong += [line + again for line in this.wrong]
            left[this.name] -= 1
            if not left[this.name]:
                print(row(each), file=sys.stderr, flush=True)
    return list(found.values())


def row(each: Counted) -> str:
    """A line of the table."""
    note = f"  not tried: {each.not_tried}" if each.not_tried else ""
    return f"{each.fault.name:20}{each.tries:8,}{len(each.lost):6}{len(each.wrong):6}{each.seconds:8.0f} s{note}"


def main() -> int:
    """Parse, try, tell."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description=__doc__)
    parser.add_argument("classes", nargs="*", help="these classes alone", metavar="CLASS")
    parser.add_argument("--seed", type=int, default=0, help="of the moments, bytes and choices (0)")
    parser.add_argument("--index", type=int, nargs="+", metavar="N", help="these tries of a class alone, from 0")
    parser.add_argument("--fast", action="store_true", help="a slice of it, for CI")
    parser.add_argument("--jobs", type=int, default=2, help="tries at a time (2)")
    parser.add_argument("--list", action="store_true", help="tell the classes")
    parser.add_argument("--page", action="store_true", help="write the table into docs/reliability.md")
    asked = parser.parse_args()
    if asked.list:
        for fault in FAULTS.values():
            print(f"{fault.name:20}{fault.tries:4}  {fault.about}")
        return 0
    if unknown := set(asked.classes) - set(FAULTS):
        parser.error(f"no class {', '.join(sorted(unknown))}; --list tells them")
    chosen = [fault for fault in FAULTS.values() if fault.name in asked.classes or not asked.classes]
    if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
        signal.signal(signal.SIGHUP, lambda number, frame: None)  # by nohup, and what is tried would ignore it, too
    begun = time.monotonic()
    bench = Bench(fast=asked.fast)
    try:
        bench.prepare()
        found = counted(chosen, asked.seed, bench, asked.index, asked.jobs)
    finally:
        bench.close()
    seconds = time.monotonic() - begun
    print(f"{'class':20}{'tries':>8}{'lost':>6}{'wrong':>6}{'time':>10}")
    for each in found:
        if each.tries or each.not_tried or not asked.fast:
            print(row(each))
    for each in found:
        for kind, lines in (("LOST", each.lost), ("WRONG", each.wrong)):
            for line in lines[:SHOWN]:
                print(f"{kind} {each.fault.name}: {line}")
            if len(lines) > SHOWN:
                print(f"{kind} {each.fault.name}: ... and {len(lines) - SHOWN} more")
    lost, wrong = sum(len(each.lost) for each in found), sum(len(each.wrong) for each in found)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    times = f"{seconds / 60:.1f} minutes ({(used.ru_utime + used.ru_stime) / 60:.1f} of a processor)"
    print(f"{sum(each.tries for each in found):,} tries in {times}: {lost} lost, {wrong} wrong")
    if asked.page:
        write_page(
            [
                (each.fault.name, each.fault.about, each.tries, len(each.lost), len(each.wrong), each.not_tried)
                for each in found
            ],
            f"python -m tests.faults --seed {asked.seed}",
            times,
        )
    return int(bool(lost or wrong))


if __name__ == "__main__":
    sys.exit(main())
