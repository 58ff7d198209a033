"""The script of the jobs of a run, for SLURM, PBS or a plain shell: each runs the shards that lack something.

A job's output goes to a file of its shard in the run's folder, by the script itself: what a queue's own options make of
a path with a space, a colon or a percent sign differs. The program takes the place of the shell, so that it gets
the signal that comes before a job's time is over, stops at the next block, and leaves what is whole.
"""

import re
import shlex
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from visitlab_cli.errors import UsageError
from visitlab_cli.jobs.packing import Packing, in_clock
from visitlab_cli.origin import JOB_LOG, SCRIPT
from visitlab_cli.storage.on_disk import JOBS
from visitlab_cli.terminal import plain
from visitlab_cli.wording import printable

SLURM, PBS, SHELL = "slurm", "pbs", "shell"
MARKS = {SLURM: "#SBATCH", PBS: "#PBS"}
WARNING = 60
"""Seconds before the end at which SLURM asks a job to end."""
INDEX = "VISITLAB_INDEX"
"""The variable that says the index of a job that is in no array, which PBS has none of one job."""
MEMORY = {
    SLURM: (re.compile(r"\d{1,9}[KMGT]?", re.ASCII | re.IGNORECASE), "a number of K, M, G or T, such as 4G"),
    PBS: (re.compile(r"\d{1,15}[KMGTP]?[BW]?", re.ASCII | re.IGNORECASE), "a number of kb, mb, gb or tb, such as 4gb"),
}
"""What each queue calls an amount of memory, and how it is told to a user."""
DIRECTIVE = {
    SLURM: (re.compile(r"--?[A-Za-z].*"), "an option of sbatch, such as --mail-type=END"),
    PBS: (re.compile(r"-[A-Za-z].*"), "an option of qsub, such as '-m e'"),
}
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")

CACHE = """\
# Compiled code is kept on the node's own disk; of jobs that share one, one compiles and the others wait for it.
: "${VISITLAB_CACHE:=${SLURM_TMPDIR:-${TMPDIR:-/tmp}}/visitlab-$(id -u)}"
export VISITLAB_CACHE
"""
INDICES = {
    SLURM: "index=$((${SLURM_ARRAY_TASK_ID:?submit with sbatch --array} + ${1:-0}))",
    PBS: f"index=${{PBS_ARRAY_INDEX:-${{{INDEX}:?submit with qsub -J}}}}",
}
ALL_HERE = """\
if [ $# -gt 0 ]; then
    for shard in "${shards[@]}"; do
        if [ "$shard" = "$1" ]; then run_shard "$1"; fi
    done
    echo "$0: $1: no such shard; there are ${shards[*]}" >&2
    exit 2
fi
case "$at_once" in
    '' | *[!0-9]* | 0*) echo "$0: AT_ONCE=$at_once: must be a number of shards, from 1 on" >&2; exit 2 ;;
esac
set -m # each shard in a group of its own: what stops this script stops each of them once
stop() {
    trap '' INT TERM HUP
    # shellcheck disable=SC2046
    kill -TERM $(jobs -pr) 2>/dev/null
    wait
    exit 130
}
trap stop INT TERM HUP
pids=()
for shard in "${shards[@]}"; do
    while [ "$(jobs -pr | wc -l)" -ge "$at_once" ]; do sleep 0.2; done
    run_shard "$shard" &
    pids+=("$!")
done
failed=0
for pid in "${pids[@]}"; do
    wait "$pid" || failed=$?
done
exit "$failed"
"""


class Request(NamedTuple):
    """What a script is of.

    `command` is visitlab as a shell runs it, `prologue` what the shell does before; `time` seconds of a job.
    """

    system: str
    run: Path
    seeds: int
    packing: Packing
    workers: int
    time: int
    command: str
    at_once: int
    most_in_array: int
    again: str
    partition: str = ""
    account: str = ""
    memory: str = ""
    directives: tuple[str, ...] = ()
    prologue: tuple[str, ...] = ()
    plugins: tuple[Path, ...] = ()

    @property
    def chunks(self) -> list[range]:
        """The indices of the jobs, in parts that an array may have."""
        count, most = len(self.packing.jobs), self.most_in_array
        return [range(first, min(first + most, count)) for first in range(0, count, most)]

    @property
    def alone(self) -> bool:
        """Whether one submission is all."""
        return len(self.chunks) == 1


def check(request: Request) -> None:
    """Refuse what can't stand in a script, or can mean nothing to the queue.

    Raises:
        UsageError: a line break, memory that is no amount, what is no option of the queue, or a path that is not text.
    """
    for name in ("partition", "account", "memory"):
        if any(letter.isspace() or letter in "#'\"\\" for letter in getattr(request, name)):
            raise UsageError(f"--{name} {getattr(request, name)}: must be one plain word")
    for name, lines in (
        ("directive", request.directives),
        ("prologue", request.prologue),
        ("command", [request.command]),
    ):
        if any("\n" in line or "\r" in line or "\0" in line for line in lines):
            raise UsageError(f"--{name}: must be one line; give the option once for each")
    if request.system in MARKS:
        _check_forms("memory", [request.memory] if request.memory else [], *MEMORY[request.system])
        _check_forms("directive", request.directives, *DIRECTIVE[request.system])
    try:
        str(request.run).encode()
    except UnicodeEncodeError:
        raise UsageError(f"{request.run}: its path is not UTF-8; choose another folder with --out") from None


def _check_forms(name: str, given: Iterable[str], form: re.Pattern[str], words: str) -> None:
    for each in given:
        if not form.fullmatch(each):
            raise UsageError(f"--{name} {printable(each) or 'without a word'}: must be {words}")


def submissions(request: Request, script: Path) -> list[list[str]]:
    """The commands that hand in a script, one for each array."""
    file = str(script)
    if request.system == SHELL:
        return [["bash", file]]
    if request.system == SLURM:
        if request.alone:
            return [["sbatch", file]]
        return [["sbatch", f"--array=0-{len(part) - 1}", file, str(part.start)] for part in request.chunks]
    if request.alone and len(request.packing.jobs) > 1:
        return [["qsub", file]]
    return [["qsub", *_in_pbs(part), file] for part in request.chunks]


def _in_pbs(part: range) -> list[str]:
    return ["-v", f"{INDEX}={part.start}"] if len(part) == 1 else ["-J", f"{part.start}-{part[-1]}"]


def script_text(request: Request, script: Path) -> str:
    """The script that `script` is to hold."""
    mark = MARKS.get(request.system)
    head = [f"{mark} {line}" for line in (*_directives(request), *request.directives)] if mark else []
    parts = ["\n".join([SCRIPT.rstrip(), *map(_comment, _about(request, script)), *head]) + "\n"]
    parts += ["\n".join([*request.prologue, ""])] if request.prologue else []
    parts += [_settings(request)]
    parts += [CACHE] if mark else []
    parts += [_function(request)]
    parts += [ALL_HERE] if not mark else [f'{INDICES[request.system]}\nrun_shard "${{shards[index]}}"\n']
    return "\n".join(parts)


def _comment(line: str) -> str:
    return f"# {plain(line)}"


def _about(request: Request, script: Path) -> list[str]:
    jobs, packing = len(request.packing.jobs), request.packing
    longest = in_clock(packing.longest, 60)
    lines = [
        f"{jobs} job{'s' if jobs != 1 else ''} of the run {request.run}, each of some {longest} at most.",
        *(f"Submit:    {shlex.join(command)}" for command in submissions(request, script)),
    ]
    if request.system == SHELL:
        lines += [
            f"One shard: {shlex.join(['bash', str(script), str(packing.jobs[0].shard)])}",
            "AT_ONCE says how many at once.",
        ]
    return [
        *lines,
        f"Watch:     {shlex.join(['visitlab', 'runs', 'watch', str(request.run)])}",
        f"Continue:  {request.again}",
        "           which writes this script anew, with jobs for what is missing; what is done stays.",
    ]


def _directives(request: Request) -> list[str]:
    name, time = request.run.name, in_clock(request.time, 1)
    fewest = 2 if request.system == PBS else 1  # PBS has no array of one
    many = request.alone and len(request.packing.jobs) >= fewest
    last = len(request.packing.jobs) - 1
    if request.system == SLURM:
        return [
            f"--job-name={name}",
            *([f"--array=0-{last}"] if many else []),
            f"--time={time}",
            "--nodes=1",
            "--ntasks=1",
            f"--cpus-per-task={request.workers}",
            *([f"--mem={request.memory}"] if request.memory else []),
            *([f"--partition={request.partition}"] if request.partition else []),
            *([f"--account={request.account}"] if request.account else []),
            f"--signal=B:TERM@{WARNING}",
            "--requeue",
            "--output=/dev/null",
        ]
    memory = f":mem={request.memory}" if request.memory else ""
    return [
        f"-N visitlab-{name[-6:]}",
        "-S /bin/bash",
        *([f"-J 0-{last}"] if many else []),
        f"-l walltime={time}",
        f"-l select=1:ncpus={request.workers}{memory}",
        *([f"-q {request.partition}"] if request.partition else []),
        *([f"-A {request.account}"] if request.account else []),
        "-r y",
        "-j oe",
        "-o /dev/null",
    ]


def _settings(request: Request) -> str:
    numbers = " ".join(str(job.shard) for job in request.packing.jobs)
    return "\n".join(
        [
            f"run={shlex.quote(str(request.run))}",
            f"out={shlex.quote(str(request.run.parent))}",
            f"of={request.packing.total}",
            f"shards=({numbers})",
            *([f"at_once=${{AT_ONCE:-{request.at_once}}}"] if request.system == SHELL else []),
            f"export {' '.join(f'{name}=1' for name in THREADS)}",
            "",
        ]
    )


def _function(request: Request) -> str:
    plugins = "".join(f" --plugin {shlex.quote(str(file))}" for file in request.plugins)
    return (
        "run_shard() {\n"
        f'    log="$run/{JOBS}/shard-$1-of-$of.log"\n'
        f'    [ -s "$log" ] || echo {shlex.quote(JOB_LOG.rstrip())} >"$log"\n'
        '    cd -- "$run" || exit\n'
        '    exec >>"$log" 2>&1 || exit\n'
        '    echo "$(date): shard $1 of $of on $(hostname)"\n'
        f'    exec {request.command} run "$run/config.yaml" seeds={request.seeds}{plugins} \\\n'
        f'        --out "$out" --shard "$1/$of" --workers {request.workers} --quiet\n'
        "}\n"
    )
