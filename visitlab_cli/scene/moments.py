"""The moments of a trial: the steps at which something changes, and those that a strip shows."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from visitlab_cli.scene.words import ENGAGED, Steps, there_already
from visitlab_cli.world.enums import InteractionLevel
from visitlab_cli.world.lab import Lab


class Moment(NamedTuple):
    """A step at which something changes; `kind` is one of the constants below."""

    step: int
    kind: str


SEEN, GREETED, CALLED, FOLLOWING = "seen", "greeted", "called", "following"
REACHED, REWARDED, LOST = "goal reached", "rewarded", "attention lost"
BEGAN_THERE = "began in the goal room"
"""A goal that nobody was led to: the human, or the robot where there is none, stood there before the first step."""
FACTS = (SEEN, GREETED, FOLLOWING, REACHED, LOST)
"""The kinds of moment that every interaction worth telling has."""

MOST_PANELS = 12
"""As many panels as a strip of one page has."""


def moments(steps: Steps, lab: Lab) -> list[Moment]:
    """The moments of a trial in `lab` in their order; of unbroken rewards in a training only the first is one."""
    return list(_moments(steps, lab))


def strip_steps(steps: Steps, lab: Lab) -> list[int]:
    """The steps that a comic strip shows: how the trial begins, then its first moments."""
    return sorted({0, *(moment.step for moment in moments(steps, lab))})[:MOST_PANELS]


def left_out(steps: Steps, shown: Sequence[int], lab: Lab) -> str:
    """What a strip that shows these steps does not: '7 more steps with a moment, up to step 93'; empty if nothing."""
    others = {moment.step for moment in moments(steps, lab)} - set(shown)
    count = f"{len(others)} more step{'' if len(others) == 1 else 's'}"
    return f"{count} with a moment, up to step {max(others)}" if others else ""


def facts(steps: Steps, lab: Lab) -> dict[str, int]:
    """The step of the first moment of each kind in `FACTS`, as far as the trial has them."""
    first: dict[str, int] = {}
    for moment in moments(steps, lab):
        first.setdefault(moment.kind, moment.step)
    return {kind: first[kind] for kind in FACTS if kind in first}


def _moments(steps: Steps, lab: Lab) -> Iterator[Moment]:
    levels, rewards = steps.get("interaction_level"), steps["reward"]
    unseen = True
    for step in range(len(rewards)):
        if levels is not None:
            before, after = (int(levels[step - 1]) if step else InteractionLevel.NOT_SEEN), int(levels[step])
            if before >= ENGAGED > after:
                yield Moment(step, LOST)
                unseen = True
            if unseen and after != InteractionLevel.NOT_SEEN:
                unseen = False
                if before < ENGAGED:
                    yield Moment(step, SEEN)
            if after >= ENGAGED and after != before:
                yield Moment(step, (GREETED, CALLED, FOLLOWING)[after - ENGAGED])
        if step and rewards[step] > 0 and ("executed_action" in steps or rewards[step - 1] == 0):
            yield Moment(step, _rewarded(steps, step, lab))


def _rewarded(steps: Steps, step: int, lab: Lab) -> str:
    if there_already(steps, step, lab):
        return BEGAN_THERE
    return REACHED if "goal_room" in steps else REWARDED
