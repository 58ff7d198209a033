"""What the planners with one learned model of the world share: what they save, and what can be wrong with it."""

from typing import Any, ClassVar

from visitlab_cli.agents.base import Saved, Setting
from visitlab_cli.agents.declared import Declared, fault_in_model, floats
from visitlab_cli.agents.sparse_model import declared_model, model_arrays, saved_model
from visitlab_cli.agents.tabular import TabularParameters


class OneModelParameters(TabularParameters):
    """Its records have a table `q`, shape (states, actions), and a `model`, a `SparseModel`."""

    plans: ClassVar[bool] = True

    @property
    def weighted(self) -> bool:
        """Whether its counts may be parts of one."""
        return False

    @property
    def played_as(self) -> str:
        """Also by what its counts are."""
        return "-".join(filter(None, (super().played_as, "weighted" if self.weighted else "")))

    @property
    def forgets(self) -> bool:
        """Where counts may be parts, some were taken back."""
        return self.weighted

    def _forget_rewards(self, record: Any) -> None:
        """The R that sweeps use is 0 until a pair is next tried."""
        record.model.mean_rewards[:] = 0.0

    def _save(self, record: Any) -> Saved:
        """Q and the learned model."""
        return {"q": record.q, **saved_model(record.model, record.q.shape[1])}

    def models(self, saved: Saved) -> dict[str, Saved]:
        """The one that it sweeps."""
        return {"model": model_arrays(saved)}

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """The table and the learned model."""
        return {"q": floats(setting.n_states, setting.n_actions), **declared_model(setting, weighted=self.weighted)}

    def _fault(self, saved: Saved) -> str | None:
        """Whether the model is one."""
        return fault_in_model(model_arrays(saved))
