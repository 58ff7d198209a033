"""What is possible at all: the exact values of the three trainings, optimal and random."""

from collections.abc import Sequence
from typing import NamedTuple

from visitlab_cli.config.experiment import Experiment, Site, lab_of
from visitlab_cli.config.experiments import SocialTraining
from visitlab_cli.config.labs import lab_called
from visitlab_cli.config.model import Config
from visitlab_cli.exact.go_to_human import go_to_human_optimum, go_to_human_random
from visitlab_cli.exact.navigation import (
    navigation_discounted,
    navigation_optimum,
    navigation_random,
)
from visitlab_cli.exact.social import optimum, random_reward, unknown
from visitlab_cli.humans.base import HumanParameters
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.social import ARENA, DIRECTION_CHANGE
from visitlab_cli.world.task import TRAINING_TRIAL_STEPS
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL


class Possible(NamedTuple):
    """The expected reward of a trial: the best that can be, and what random actions get."""

    optimum: float
    random: float

    def share(self, value: float) -> float:
        """How much of what learning can gain over chance a `value` is: 0 as random, 1 as the optimum."""
        return (value - self.random) / (self.optimum - self.random)


class ExactValue(NamedTuple):
    """One line of `visitlab optimum`; `success`, `human` and `lab` are empty where the task has none.

    `digits` are those behind the point that are exact.
    """

    task: str
    success: str
    measure: str
    optimal: float
    random: float
    human: str = ""
    digits: int = 4
    lab: str = ""


def possible(
    settings: Experiment, distances: tuple[int, ...] = DISTANCES, human: HumanParameters | None = None
) -> Possible | None:
    """What a trial of an experiment can bring; None where that is not known, or it takes place in several labs.

    Args:
        settings: of the experiment.
        distances: the four thresholds of distance, in cells.
        human: who is met, if anybody is.
    """
    lab, steps = lab_of(settings), settings.trial_steps
    if len(set(settings.labs)) > 1:
        return None
    if settings.task == NAVIGATION:
        return Possible(navigation_optimum(steps, lab), navigation_random(steps, lab))
    if settings.task == GO_TO_HUMAN:
        task = settings.task_in(Site(lab, None, distances, {}))
        options = steps, "seen" if task.seen_is_enough else "facing", distances, lab
        return Possible(go_to_human_optimum(*options), go_to_human_random(*options))
    if isinstance(settings, SocialTraining) and human is not None:
        if unknown(human, steps, settings.arena, distances):
            return None
        rules = human, steps, settings.arena, settings.direction_change, distances
        return Possible(optimum(*rules), random_reward(*rules))
    return None


def exact_values(
    gamma: float, config: Config, labs: Sequence[str], humans: Sequence[str]
) -> tuple[list[ExactValue], list[str]]:
    """Those of labs and humans of a config, means over random starts, and for whom there are none, and why.

    Trials are as long as those of the config's own trainings, or as by default; the social task's other settings, too.

    Args:
        gamma: the discount factor of navigation's discounted values, in [0, 1).
        config: which declares them.
        labs: the names of labs in which navigation and go_to_human take place.
        humans: the names of those who are met in the social task.
    """
    distances, trainings = config.interaction.distances, config.experiments.values()
    lines, unknowns = [], []

    def lengths(task: str) -> list[int]:
        return sorted({each.trial_steps for each in trainings if each.task == task}) or [TRAINING_TRIAL_STEPS]

    for name in labs:
        lab = lab_called(name, config.labs)
        for steps in lengths(NAVIGATION):
            values = navigation_optimum(steps, lab), navigation_random(steps, lab)
            lines.append(ExactValue(NAVIGATION, "", _sum_of(steps), *values, lab=name))
        discounted = f"discounted, gamma {gamma:g}"
        lines.append(ExactValue(NAVIGATION, "", discounted, *navigation_discounted(gamma, lab), lab=name))
        for steps in lengths(GO_TO_HUMAN):
            for success in ("facing", "seen"):
                options = steps, success, distances, lab
                values = go_to_human_optimum(*options), go_to_human_random(*options)
                lines.append(ExactValue(GO_TO_HUMAN, success, _sum_of(steps), *values, lab=name))
    social = [each for each in trainings if isinstance(each, SocialTraining)]
    worlds = {(each.trial_steps, each.arena, each.direction_change): None for each in social}
    for name in humans:
        human = config.humans[name]
        for steps, arena, change in worlds or {(TRAINING_TRIAL_STEPS, ARENA, DIRECTION_CHANGE): None}:
            if why := unknown(human, steps, arena, distances):
                unknowns.append(f"{SOCIAL}, {name}: {why}")
                continue
            rules = human, steps, arena, change, distances
            values = optimum(*rules), random_reward(*rules)
            lines.append(ExactValue(SOCIAL, "", _sum_of(steps), *values, name, digits=2))
    return lines, unknowns


def _sum_of(steps: int) -> str:
    return f"reward of a trial of {steps} steps"
