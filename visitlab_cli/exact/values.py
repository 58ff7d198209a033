"""What is possible at all: the exact values of the three trainings, optimal and random."""

from typing import NamedTuple

from visitlab_cli.config.experiment import Experiment, Site, lab_of
from visitlab_cli.config.experiments import SocialTraining
from visitlab_cli.config.files import shipped_folder
from visitlab_cli.config.loading import load
from visitlab_cli.exact.go_to_human import go_to_human_optimum, go_to_human_random
from visitlab_cli.exact.navigation import (
    navigation_optimal_q,
    navigation_optimum,
    navigation_random,
    navigation_random_discounted,
)
from visitlab_cli.exact.social import optimum, random_reward, unknown
from visitlab_cli.humans.base import HumanParameters
from visitlab_cli.world.geometry import DISTANCES
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
    """One line of `visitlab optimum`; `success` and `human` are empty where the task has none.

    `digits` are those behind the point that are exact.
    """

    task: str
    success: str
    measure: str
    optimal: float
    random: float
    human: str = ""
    digits: int = 4


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


def exact_values(gamma: float) -> list[ExactValue]:
    """All of them: sums of a trial of 20 steps, and navigation's discounted values, means over random starts.

    The social task's are those of the paper's humans.

    Args:
        gamma: the discount factor, in [0, 1).
    """
    steps = TRAINING_TRIAL_STEPS
    undiscounted = f"reward of a trial of {steps} steps"
    discounted = f"discounted, gamma {gamma:g}"
    best = float(navigation_optimal_q(gamma).max(axis=1).mean())
    lines = [
        ExactValue(NAVIGATION, "", undiscounted, navigation_optimum(steps), navigation_random(steps)),
        ExactValue(NAVIGATION, "", discounted, best, navigation_random_discounted(gamma)),
    ]
    for success in ("facing", "seen"):
        values = go_to_human_optimum(steps, success), go_to_human_random(steps, success)
        lines.append(ExactValue(GO_TO_HUMAN, success, undiscounted, *values))
    for name, human in load(shipped_folder() / "paper.yaml").humans.items():
        lines.append(ExactValue(SOCIAL, "", undiscounted, optimum(human), random_reward(human), name, digits=2))
    return lines
