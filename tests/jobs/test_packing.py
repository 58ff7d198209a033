"""How many jobs a run's missing cells make, and that what a refusal proposes fits."""

import re

import pytest

from visitlab_cli.config.loading import load
from visitlab_cli.errors import UsageError
from visitlab_cli.jobs.packing import AROUND, LEAST, Limits, in_clock, pack, seconds_in
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.estimate import seconds_of
from visitlab_cli.plan.shards import shards

CELLS = plan(load("quickstart", ["seeds=60"]))
TOTAL = sum(seconds_of(cell) for cell in CELLS)
MARGIN = 1000 / TOTAL  # whatever a version's steps cost, these make jobs of as many seconds
ANY = Limits(jobs=1000, seconds=None, cells=0, workers=1, margin=MARGIN)


def test_every_missing_cell_has_one_job_and_what_is_done_has_none():
    few = ANY._replace(cells=10)
    whole = pack(CELLS, CELLS, few)
    assert (whole.total, sum(job.cells for job in whole.jobs)) == (24, len(CELLS))
    missing = shards(CELLS, 3)[1][:20]
    rest = pack(CELLS, missing, few)
    assert sum(job.cells for job in rest.jobs) == 20
    for job in rest.jobs:
        assert job.cells == len(
            {cell.path for cell in shards(CELLS, rest.total)[job.shard - 1]} & {c.path for c in missing}
        )
    assert pack(CELLS, [], ANY).jobs == ()


def test_a_job_is_worth_its_start_and_has_time():
    long = pack(CELLS, CELLS, ANY)
    assert len(long.jobs) == max(1, int(TOTAL / LEAST))
    for seconds in (AROUND + 60, AROUND + 200):
        found = pack(CELLS, CELLS, ANY._replace(seconds=seconds))
        assert found.longest <= seconds
        assert len(found.jobs) <= 2 * MARGIN * TOTAL / (seconds - AROUND)
    shared = pack(CELLS, CELLS, ANY._replace(workers=4, cells=60))
    assert shared.longest < pack(CELLS, CELLS, ANY._replace(cells=60)).longest / 1.5


@pytest.mark.parametrize(
    "limits",
    [
        ANY._replace(jobs=2, seconds=240),
        ANY._replace(seconds=240, cells=120),
        ANY._replace(seconds=182),
        ANY._replace(jobs=3, seconds=1000, margin=15 * MARGIN),
    ],
)
def test_what_a_refusal_proposes_fits(limits):
    with pytest.raises(UsageError) as refused:
        pack(CELLS, CELLS, limits)
    line = str(refused.value)
    longer = re.search(r"; --time ([\d:]+)", line)[1]
    assert pack(CELLS, CELLS, limits._replace(seconds=seconds_in(longer))).longest <= seconds_in(longer)
    if more := re.search(r"--jobs (\d+)", line):
        assert pack(CELLS, CELLS, limits._replace(jobs=int(more[1]), cells=0)).longest <= limits.seconds
    else:
        assert limits.seconds < 2 * AROUND


@pytest.mark.parametrize(("clock", "seconds"), [("0:00:01", 1), ("1:30:00", 5400), ("2-12:00:00", 216_000)])
def test_times(clock, seconds):
    assert seconds_in(clock) == seconds
    assert seconds_in(in_clock(seconds, 1)) == seconds
    assert seconds <= seconds_in(in_clock(seconds)) < seconds + 600
