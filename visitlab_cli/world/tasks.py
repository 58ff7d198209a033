"""The sizes of the four tasks' tables, by the task's name."""

from typing import NamedTuple

from visitlab_cli.world import go_to_human, navigation, social
from visitlab_cli.world.columns import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT


class TaskSize(NamedTuple):
    """How many states and actions the deciding module has."""

    n_states: int
    n_actions: int


TASK_SIZES = {
    NAVIGATION: TaskSize(navigation.N_STATES, navigation.N_ACTIONS),
    GO_TO_HUMAN: TaskSize(go_to_human.N_STATES, go_to_human.N_ACTIONS),
    SOCIAL: TaskSize(social.N_STATES, social.N_ACTIONS),
    VISIT: TaskSize(social.N_STATES, social.N_ACTIONS),
}
