"""The four environments; what they share is in `environment.py`, their settings in `places.py`, their pages in docs."""

import numpy as np
import numpy.typing as npt

from visitlab_cli.exact.go_to_human import go_to_human_motion
from visitlab_cli.exact.models import Expected, Known, go_to_human_model, navigation_model
from visitlab_cli.exact.motion import Motion, Table
from visitlab_cli.exact.navigation import navigation_motion
from visitlab_cli.gym.environment import Environment
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT


class NavigationEnv(Environment):
    """`visitlab/Navigation-v0`: reach the goal room and stay in it (docs/environments/navigation.md).

    Settings: `trial_steps`, `lab`.
    """

    task = NAVIGATION

    @property
    def P(self) -> npt.NDArray[np.int64]:  # noqa: N802  (as toy_text calls it)
        """The state that follows each state and action, for sure: shape (5184, 25) in the paper's lab."""
        return self._model.P

    @property
    def R(self) -> Table:  # noqa: N802
        """The reward of each state and action, shape (5184, 25)."""
        return self._model.R

    @property
    def motion(self) -> Motion:
        """Where moves end, whatever the goal: `after` (cells, 25), `reward` (cells, goal rooms)."""
        return navigation_motion(self._place.lab)

    @property
    def _model(self) -> Known:
        return navigation_model(self._place.lab)


class GoToHumanEnv(Environment):
    """`visitlab/GoToHuman-v0`: get in front of a human who stands still (docs/environments/go_to_human.md).

    Settings: `trial_steps`, `success`, `distances`, `lab`.
    """

    task = GO_TO_HUMAN

    @property
    def P(self) -> Table:  # noqa: N802
        """The probability of each next state, shape (320, 25, 320): the mean over all cells and headings."""
        return self._model.P

    @property
    def R(self) -> Table:  # noqa: N802
        """The expected reward of each state and action, shape (320, 25), likewise."""
        return self._model.R

    @property
    def motion(self) -> Motion:
        """The exact motion, for who knows all: `after` (cells, 25), `reward` (cells, humans: cell x heading)."""
        return go_to_human_motion(self._success, self._place.distances, self._place.lab)

    @property
    def _success(self) -> str:
        return "seen" if self._place.record.seen_is_enough else "facing"

    @property
    def _model(self) -> Expected:
        return go_to_human_model(self._success, self._place.distances, self._place.lab)


class SocialEnv(Environment):
    """`visitlab/Social-v0`: win a human's attention and lead it in a direction (docs/environments/social.md).

    Settings: `human`, `trial_steps`, `arena`, `direction_change`, `distances`.
    """

    task = SOCIAL


class VisitEnv(Environment):
    """`visitlab/Visit-v0`: lead a human from goal room to goal room (docs/environments/visit.md).

    Settings: `human`, `modules`, `trial_steps`, `goal_rooms`, `distances`, `lab`.
    """

    task = VISIT
