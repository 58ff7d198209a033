"""Queues that are none: an `sbatch`, `qsub` and `scontrol` that keep what they are told, and really run the jobs."""

import json
import stat
import sys

QUEUE = """\
#!{python}
import json, os, pathlib, re, shutil, subprocess, sys
here = pathlib.Path(__file__).parent
program, given = pathlib.Path(__file__).name, sys.argv[1:]
with (here / "told").open("a") as told:
    told.write(json.dumps([program, *given]) + "\\n")
options, words = [], list(given)
value = {{"-J", "-v"}}
while words and words[0].startswith("-"):
    options.append(words.pop(0))
    options += [words.pop(0)] if options[-1] in value else []
script, *words = words
copy = here / "job script"  # as a queue makes one
shutil.copy(script, copy)
for line in pathlib.Path(script).read_text().splitlines():
    if line.startswith(("#SBATCH", "#PBS")):
        options[:0] = line.split(maxsplit=1)[1].split(maxsplit=1 if program == "qsub" else 0)
said = " ".join(options)
array = re.findall(r"(?:--array=|-J )(\\d+)-(\\d+)", said)
variable = {{"sbatch": "SLURM_ARRAY_TASK_ID", "qsub": "PBS_ARRAY_INDEX"}}[program]
more = dict(re.findall(r"-v (\\w+)=(\\w+)", said))
indices = range(int(array[-1][0]), int(array[-1][1]) + 1) if array else [None]
if {runs}:
    for index in indices:
        variables = os.environ | more | ({{variable: str(index)}} if index is not None else {{}})
        subprocess.run(["bash", str(copy), *words], cwd="/", env=variables, stdin=subprocess.DEVNULL)
number = sum(1 for _ in (here / "told").open())
print(f"{{number}};cluster" if program == "sbatch" else f"{{number}}[].server")
"""
VISITLAB = """\
#!{python}
import json, os, pathlib, sys, time
here = pathlib.Path(__file__).parent
names = ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS", "VISITLAB_CACHE")
begun = time.monotonic()
{does}
call = {{"words": sys.argv[1:], "process": os.getpid(), "begun": begun, "ended": time.monotonic()}}
call |= {{name: os.environ.get(name) for name in names}}
with (here / "calls").open("a") as calls:
    calls.write(json.dumps(call) + "\\n")
"""


def program(folder, name, text):
    folder.mkdir(exist_ok=True)
    file = folder / name
    file.write_text(text)
    file.chmod(file.stat().st_mode | stat.S_IXUSR)
    return file


def queue(folder, name, runs=True):
    """A program `sbatch` or `qsub` in a folder."""
    return program(folder, name, QUEUE.format(python=sys.executable, runs=runs))


def fake_visitlab(folder, does=""):
    """A program that notes its arguments, its process, some variables and when it ran."""
    return program(folder, "fake visitlab", VISITLAB.format(python=sys.executable, does=does))


def lines_of(file):
    return [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
