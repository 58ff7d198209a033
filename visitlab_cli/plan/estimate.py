"""What a plan would cost before it runs: steps, time and disk, from costs that were measured once.

The costs are those of whole cells of 400,000 steps (visits of 100,000) of this version on one core of an ordinary
2026 server, compiled before, every step recorded, planning as often as by default. Elsewhere they are off by what
the machine is faster or slower; twice as much or half as much is still the right order.
"""

from collections.abc import Sequence
from typing import NamedTuple

from visitlab_cli.agents.registry import KINDS
from visitlab_cli.agents.uniform_random import RandomParameters
from visitlab_cli.plan.cells import Cell
from visitlab_cli.world.tasks import SOCIAL, VISIT

LOG_BYTES = 11_000.0
"""A log without steps: schema, config, index."""

TRIAL_BYTES = 7.0
"""A trial's row in `trials.parquet`."""
CELL_BYTES = 3_000.0
"""The files of a cell with nothing in them."""

MODEL_STEPS, MODEL_GROWTH = 200_000, 0.7
"""When hardly anything new is met in a model; before, it grows with a power of the steps."""
WITHOUT_COUNTS = 0.25
"""What of it an agent has that learns and keeps no counts."""

PLAIN = 3.3
"""Microseconds of a step of an agent in plain Python that does not tell them: of a table of Q-learning."""

SWEEP_SECONDS = 0.25e-3
"""A sweep of a model that has met most of the social task, and longer than any of the other tasks'."""
USUALLY = {VISIT: 100}
"""How often is planned by what `microseconds_a_step` tells, where that is not by the kind's own default."""


class Estimate(NamedTuple):
    """What cells would cost: `steps`, `seconds` on so many workers, `bytes` on the disk."""

    cells: int
    steps: int
    seconds: float
    bytes: int


def estimate(cells: Sequence[Cell], workers: int) -> Estimate:
    """The cost of running `cells` on `workers` processes, compiling not counted.

    A cell runs on one worker and a visit waits for its modules, so more workers than cells gain nothing.
    """
    seconds = {cell.path: seconds_of(cell) for cell in cells}
    longest = max(earliest_ends(cells, seconds).values(), default=0.0)
    shared = sum(seconds.values()) / max(workers, 1)
    size = sum(_bytes(cell) for cell in cells)
    return Estimate(len(cells), sum(cell.steps for cell in cells), max(shared, longest), round(size))


def seconds_of(cell: Cell) -> float:
    """What a cell would take of one core."""
    agent = RandomParameters if cell.frozen else cell.config.agents[cell.agent]  # frozen: neither learns nor plans
    told = agent.microseconds_a_step.get(cell.task, PLAIN if not agent.compiled() else _dearest(cell.task))
    planning = cell.trials * cell.settings.seconds_a_trial
    told = max(0.0, told - cell.settings.plays.costs.recording * (1 - _recorded(cell) / cell.steps))
    return cell.settings.plays.costs.seconds + planning + cell.steps * (told / 1e6 + _more_sweeps(cell))


def _more_sweeps(cell: Cell) -> float:
    """Seconds a step for planning more often than usual."""
    often = None if cell.frozen else getattr(cell.learner, "plan_every", None)
    if often is None:
        return 0.0
    usual = USUALLY.get(cell.task, type(cell.learner).model_fields["plan_every"].default)
    return SWEEP_SECONDS * max(0.0, 1 / int(often) - 1 / int(usual))


def _dearest(task: str) -> float:
    """The microseconds of a step of the dearest kind that tells them."""
    return max(kind.microseconds_a_step.get(task, 0.0) for kind in KINDS.values())


def earliest_ends(cells: Sequence[Cell], seconds: dict[str, float]) -> dict[str, float]:
    """When each cell would end at the earliest, each after those of the cells that it needs; a plan is in order."""
    ends: dict[str, float] = {}
    for cell in cells:
        begins = max((ends.get(path, 0.0) for path in cell.modules.values()), default=0.0)
        ends[cell.path] = begins + seconds[cell.path]
    return ends


def _bytes(cell: Cell) -> float:
    return CELL_BYTES + cell.trials * TRIAL_BYTES + _log_bytes(cell) + _model_bytes(cell)


def _recorded(cell: Cell) -> int:
    """The steps that are recorded: of the first trial at least where of any."""
    one_in = cell.config.record.one_trial_in
    return min(cell.steps, -(-cell.trials // one_in) * cell.settings.trial_steps) if one_in else 0


def _log_bytes(cell: Cell) -> float:
    """Of `steps.mcap`: nothing where no trial is recorded."""
    steps = _recorded(cell)
    return LOG_BYTES + steps * cell.settings.plays.costs.log_bytes_a_step if steps else 0.0


def _model_bytes(cell: Cell) -> float:
    """Of `model.npz`, which has what was met; in a visit that of the social module, and its training is in it."""
    start = cell.settings.starts.get(SOCIAL)
    steps = cell.steps + (0 if start is None else cell.config.experiments[start.experiment].n_steps)
    agent = cell.config.agents[cell.agent]
    share = 1.0 if agent.plans else WITHOUT_COUNTS if agent.learns else 0.0
    return share * cell.settings.plays.costs.model_bytes * float(min(1.0, (steps / MODEL_STEPS) ** MODEL_GROWTH))
