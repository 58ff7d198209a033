"""What agents with tables over states share: they may keep one row for all states that are the same by symmetry."""

from abc import abstractmethod
from typing import Any

from pydantic import Field

from visitlab_cli.agents.base import AgentParameters, Saved, Setting
from visitlab_cli.agents.declared import Declared
from visitlab_cli.agents.symmetry import Symmetric, fault_in_fold, fold, folded, symmetric, unfolded
from visitlab_cli.settings import since
from visitlab_cli.world.tasks import SOCIAL, VISIT


class TabularParameters(AgentParameters):
    """A kind has `_create`, `_restore` and `_save`, as `AgentParameters` asks of one that is not symmetric."""

    symmetric: bool = Field(
        default=False,
        description="whether states that differ by a turn or a reflection of the lab are learned as one; only in the "
        "social task and the visit, and of what plans on a model only with `unvisited: zero`",
        json_schema_extra=since("0.2.0"),
    )

    @property
    def played_as(self) -> str:
        """Symmetric, where it is."""
        return "symmetric" if self.symmetric else ""

    @property
    def playable(self) -> tuple[str, ...]:
        """Where it is symmetric, the tasks whose states have directions."""
        return (SOCIAL, VISIT) if self.symmetric else self.tasks

    def goes_on_from(self, other: AgentParameters) -> str | None:
        """Only one that is symmetric from one that is."""
        if self.symmetric == getattr(other, "symmetric", False):
            return None
        return "of the two only one is symmetric"

    def create(self, setting: Setting) -> Any:
        """A new agent's record."""
        if not self.symmetric:
            return self._create(setting)
        return symmetric(self._create(_inner(setting)))

    def restore(self, setting: Setting, saved: Saved) -> Any:
        """The record that goes on from saved arrays."""
        if not self.symmetric:
            return self._restore(setting, saved)
        return symmetric(self._restore(_inner(setting), folded(saved)))

    def save(self, record: Any) -> Saved:
        """`q` of all states; counts in the rows of the states that stand for others, where it is symmetric."""
        return unfolded(self._save(record.inner)) if isinstance(record, Symmetric) else self._save(record)

    def fault(self, setting: Setting, saved: Saved) -> str | None:
        """Also whether they are symmetric."""
        return self._fault(saved) or (fault_in_fold(saved) if self.symmetric else None)

    def planning_every(self, record: Any, steps: int) -> Any:
        """It is the record that learns which plans."""
        if isinstance(record, Symmetric):
            return record._replace(inner=super().planning_every(record.inner, steps))
        return super().planning_every(record, steps)

    def meet(self, record: Any, human: int) -> None:
        """It is the record that learns which is told."""
        self._meet(self.learning(record), human)

    @staticmethod
    def learning(record: Any) -> Any:
        """The record that has the tables."""
        return record.inner if isinstance(record, Symmetric) else record

    def forget_rewards(self, record: Any) -> None:
        """Of the record that learns."""
        self._forget_rewards(self.learning(record))

    @abstractmethod
    def _create(self, setting: Setting) -> Any: ...

    @abstractmethod
    def _restore(self, setting: Setting, saved: Saved) -> Any: ...

    @abstractmethod
    def _save(self, record: Any) -> Saved: ...

    @abstractmethod
    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """What `save` gives."""

    def _fault(self, saved: Saved) -> str | None:
        return None

    def _forget_rewards(self, record: Any) -> None:
        """Nothing, of one that does not plan."""

    def _meet(self, record: Any, human: int) -> None:
        """To one that finds out by itself it is nothing."""


def _inner(setting: Setting) -> Setting:
    return setting._replace(n_states=len(fold().kept))
