"""Two commits side by side: whole commands of each, in turn, by CPU time; a case that became too slow is named.

    python -m benchmarks.commits OLD [NEW] [--rounds N] [--only PART] [--at-most RATIO]

OLD and NEW are anything that git knows; NEW left out is the working tree as it is. Both run with this environment's
packages, each with its own cache of compiled code, filled before anything is measured. Told is the ratio of CPU
seconds new / old of each case, pair by pair: median, least, most. Exit code 1 where a median is above RATIO.
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

ROOT = Path(__file__).parents[1]
HEAD = """
name: commits
humans: {human: {p_S: [0, 0.5, 0.5], p_H: 0.05, p_M: 0.05, p_O: 0.15, p_A: 0.05}}
agents: {mb: {kind: model_based}, mf: {kind: q_learning}}
"""
TRAININGS = """
  navigation: {task: navigation, agents: [mb], steps: 200000}
  go_to_human: {task: go_to_human, agents: [mb], steps: 200000}
  social: {task: social, agents: [mb], humans: [human], steps: 500000}
"""
VISIT = """
  visit:
    task: visit
    modules: {navigation: navigation/mb, go_to_human: go_to_human/mb, social: social/mb/human}
    humans: [human]
    trials: TRIALS
"""
CONFIGS = {
    "navigation, 2,000,000 steps, not recorded": HEAD
    + "experiments: {navigation: {task: navigation, agents: [mf], steps: 2000000}}\nrecord: {steps: none}\n",
    "social, 1,000,000 steps, not recorded": HEAD
    + "experiments: {social: {task: social, agents: [mb], humans: [human], steps: 1000000}}\nrecord: {steps: none}\n",
    "social, 500,000 steps, recorded": HEAD
    + "experiments: {social: {task: social, agents: [mb], humans: [human], steps: 500000}}\n",
    "a visit of 1,000 trials and its modules, recorded": HEAD
    + f"experiments:{TRAININGS}{VISIT.replace('TRIALS', '1000')}",
    "100 cells of 2,000 steps, recorded": HEAD
    + "experiments: {social: {task: social, agents: [mb], humans: [human], steps: 2000}}\nseeds: 100\n",
}
PAPER = "the paper's config, one seed, recorded"
HELP = "visitlab --help"
CASES = (*CONFIGS, PAPER, HELP)


def unpacked(commit: str, folder: Path) -> Path:
    """A commit's files in `folder`."""
    packed = subprocess.run(["git", "archive", commit], cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout
    with tarfile.open(fileobj=BytesIO(packed)) as archive:
        archive.extractall(folder, filter="data")
    return folder


def command_of(case: str, code: Path, folder: Path) -> list[str]:
    """The command of a case, which writes below `folder`."""
    program = [sys.executable, "-m", "visitlab_cli"]
    if case == HELP:
        return [*program, "--help"]
    options = ["--out", str(folder / "runs"), "--workers", "1", "--quiet"]
    if case == PAPER:
        return [*program, "run", str(code / "configs" / "paper.yaml"), "seeds=1", *options]
    config = folder / "config.yaml"
    config.write_text(CONFIGS[case])
    return [*program, "run", str(config), *options]


def cpu_seconds(case: str, code: Path, cache: Path) -> float:
    """Of a whole command, in a new folder."""
    with tempfile.TemporaryDirectory() as folder:
        command = command_of(case, code, Path(folder))
        environment = os.environ | {"PYTHONPATH": str(code), "VISITLAB_CACHE": str(cache)}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, env=environment, cwd=folder, check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def compare(old: Path, new: Path, cases: Sequence[str], rounds: int, caches: Path) -> dict[str, list[float]]:
    """The ratios of each case, printed as they come."""
    found = {}
    for case in cases:
        sides = (old, caches / "old"), (new, caches / "new")
        for code, cache in sides:
            cpu_seconds(case, code, cache)
        pairs = []
        for number in range(rounds):
            order = sides if number % 2 == 0 else sides[::-1]
            seconds = {code: cpu_seconds(case, code, cache) for code, cache in order}
            pairs.append((seconds[old], seconds[new]))
        found[case] = ratios = [b / a for a, b in pairs]
        before, after = (statistics.median(side) for side in zip(*pairs, strict=True))
        told = f"{statistics.median(ratios):8.3f}{min(ratios):8.3f}{max(ratios):8.3f}"
        print(f"{case:52}{before:10.3f}{after:10.3f}{told}", flush=True)
    return found


def main() -> int:
    """The exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("old", help="a commit")
    parser.add_argument("new", nargs="?", help="another; the working tree unless given")
    parser.add_argument("--rounds", type=int, default=5, help="pairs of each case")
    parser.add_argument("--only", action="append", default=[], metavar="PART", help="of a case's name; may be repeated")
    parser.add_argument("--at-most", type=float, metavar="RATIO", help="new / old above which a case fails")
    asked = parser.parse_args()
    cases = [case for case in CASES if not asked.only or any(part in case for part in asked.only)]
    if not cases:
        parser.error(f"no case has that in its name; there are: {'; '.join(CASES)}")
    print(f"{'CPU seconds of the whole command':52}{'old':>10}{'new':>10}{'new/old':>8}{'least':>8}{'most':>8}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        old = unpacked(asked.old, folder / "old")
        new = unpacked(asked.new, folder / "new") if asked.new else ROOT
        found = compare(old, new, cases, asked.rounds, folder)
    slow = [case for case, each in found.items() if asked.at_most and statistics.median(each) > asked.at_most]
    for case in slow:
        print(f"too slow: {case}: {statistics.median(found[case]):.3f}, at most {asked.at_most}", file=sys.stderr)
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main())
