"""The task `go_to_human`: get to where the human sees and faces the robot; the human stands still."""

from collections.abc import Sequence
from typing import NamedTuple

from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.enums import (
    N_DIRECTIONS,
    InteractionLevel,
)
from visitlab_cli.world.geometry import DISTANCES, Geometry, is_appropriate, make_geometry
from visitlab_cli.world.lab import Lab, paper_lab
from visitlab_cli.world.robot import acted
from visitlab_cli.world.scene import Scene, acted_scene, before_trial, first_scene, random_body, related, with_aims
from visitlab_cli.world.task import BEGIN_TRIAL, OBSERVE, STEP, TRAINING_TRIAL_STEPS


class GoToHuman(NamedTuple):
    """`seen_is_enough`: success where the human merely sees the robot, not only where it faces it."""

    lab: Lab
    geometry: Geometry
    trial_steps: int
    seen_is_enough: bool


def make_go_to_human(
    trial_steps: int = TRAINING_TRIAL_STEPS,
    success: str = "facing",
    distances: Sequence[int] = DISTANCES,
    lab: Lab | None = None,
) -> GoToHuman:
    """The task in `lab`, the paper's unless given; `success` is `facing` or `seen`."""
    lab = lab or paper_lab()
    return GoToHuman(lab, make_geometry(lab.rows, lab.cols, distances), trial_steps, success == "seen")


@kernel
def go_to_human_state(scene: Scene) -> int:
    """State index: angle + 8 (human_heading + 8 distance)."""
    return scene.angle + N_DIRECTIONS * (scene.human_heading + N_DIRECTIONS * scene.distance)


@kernel
def is_success(scene: Scene, seen_is_enough: bool) -> bool:
    """At an appropriate distance and faced (or seen) by the human, whatever the robot's heading."""
    level = scene.interaction_level
    faced = level == InteractionLevel.HUMAN_FACES or level == InteractionLevel.BOTH_FACE
    seen = seen_is_enough and level != InteractionLevel.NOT_SEEN
    return is_appropriate(scene.distance) and (faced or seen)


@BEGIN_TRIAL.of(GoToHuman)
def begin_trial(task: GoToHuman, last: Scene, random: RandomState) -> Scene:
    """All cells and headings random."""
    last = before_trial(task.lab, last, random)
    robot = random_body(task.lab, random)
    human = random_body(task.lab, random)
    return with_aims(first_scene(task.lab, task.geometry, last, robot, human), 0, 0)


@STEP.of(GoToHuman)
def step(task: GoToHuman, scene: Scene, action: int, random: RandomState) -> tuple[Scene, float, float]:
    """A reward of 1 where the step ends in success."""
    after = related(task.lab, task.geometry, acted_scene(scene, acted(task.lab, scene, action), action))
    reward = 1.0 if is_success(after, task.seen_is_enough) else 0.0
    return after, reward, reward


@OBSERVE.of(GoToHuman)
def observe(task: GoToHuman, scene: Scene) -> int:
    """`go_to_human_state`."""
    return go_to_human_state(scene)
