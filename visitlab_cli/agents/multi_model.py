"""Several models of the world, one for each kind of human that was met, over what they have in common.

Each model has its own counts; the active one plans by these and by those of the others together, as a prior. It is
never told who comes: whether another human is there is judged at each step, before it is counted, by how well each
model foretold the change of (level, distance, angle): a CUSUM for each model, and one for a candidate that has learned
since it last began anew (Alegre, Bazzan and da Silva 2021, with a real candidate). The desired direction is summed
out, for it is not the human's. At a switch the steps since the change are taken from the old model and given to the
new one (Chartouny, Khamassi and Girard 2025).
"""

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, LEARN, TELL, Saved, Setting, zeros
from visitlab_cli.agents.declared import Declared, counts, fault_in_model, floats
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as
from visitlab_cli.agents.model_based import ModelBased
from visitlab_cli.agents.model_switching import (
    ACTIVE,
    GATHER_EVERY,
    GATHERED,
    MEMORY,
    MODELS,
    MOST,
    MOST_HUMANS,
    MOST_SWITCHES,
    N_CONTEXTS,
    NEVER,
    STEP,
    SWITCHED,
    Detection,
    Journal,
    MultiModel,
    activate,
    contexts,
    gather,
    strongest_evidence,
    take_in,
)
from visitlab_cli.agents.sparse_model import (
    ARRAYS,
    Ints,
    SparseModel,
    declared_model,
    empty_model,
    model_arrays,
    restored_model,
    saved_model,
    sweep,
)
from visitlab_cli.agents.swept import SweptParameters
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.settings import since
from visitlab_cli.world.columns import MODELS as MODELS_PART
from visitlab_cli.world.columns import StepColumns
from visitlab_cli.world.enums import Action
from visitlab_cli.world.tasks import SOCIAL, VISIT


class MultiModelParameters(SweptParameters):
    """In a visit a model for each kind of human that it meets; in training it is model_based."""

    pools: ClassVar[bool] = True
    takes_masks: ClassVar[bool] = True
    parts: ClassVar[tuple[str, ...]] = (MODELS_PART,)
    tasks: ClassVar[tuple[str, ...]] = (SOCIAL, VISIT)
    microseconds_a_step: ClassVar[Mapping[str, float]] = {SOCIAL: 0.77, VISIT: 7.1}
    """In a visit with phases and some five models; it grows with what they know, to twice that from a pool of three."""
    symmetric: ClassVar[bool] = False  # type: ignore[misc]
    never: ClassVar[Mapping[str, str]] = {"symmetric": "its models are of all states"}
    kind: Literal["multi_model"]
    told: bool = Field(
        default=False,
        description="whether it is told which phase's human comes, of whom the first has the trained model; without "
        "phases nobody is told; else it finds out",
        json_schema_extra=since("0.2.0"),
    )

    @property
    def forgets(self) -> bool:
        """What one model counted goes to another."""
        return True

    def _create(self, setting: Setting) -> ModelBased | MultiModel:
        """Q of zeros and an empty model, in a visit the first of several."""
        one = self._one(zeros(setting), empty_model(setting, np.float64 if self.weighted else np.int32))
        return self._several(setting, super()._save(one)) if setting.task == VISIT else one

    def _restore(self, setting: Setting, saved: Saved) -> ModelBased | MultiModel:
        """Go on with one model, in a visit as the first of several."""
        if setting.task == VISIT:
            return self._several(setting, saved)
        return self._one(saved["q"].copy(), restored_model(setting, saved))

    def _one(self, q: Table, model: SparseModel) -> ModelBased:
        gamma, epsilon = float(self.gamma), float(self.epsilon)
        return ModelBased(q, np.zeros(len(q)), model, gamma, epsilon, self.plan_every, self.fills)

    def _several(self, setting: Setting, saved: Saved) -> MultiModel:
        states, actions = saved["q"].shape
        context = contexts(states)
        twice = 2 * setting.steps  # a step is counted once, and once more where it is given to another model
        detected = setting._replace(n_states=(MOST + 1) * N_CONTEXTS, steps=twice + setting.steps)
        detection = Detection(
            context,
            restored_model(detected, _padded(_by_context(saved, context), MOST + 1)),
            np.zeros(MOST + 1),
            np.zeros(MOST + 1, np.int64),
        )
        seen = len(saved["successor_states"])
        record = MultiModel(
            qs=np.zeros((MOST, states, actions)),
            values=np.zeros(states),
            own=restored_model(setting._replace(n_states=MOST * states, steps=twice), _padded(saved, MOST)),
            plan=empty_model(setting._replace(steps=twice + seen + GATHER_EVERY), np.float64),
            detection=detection,
            journal=Journal(np.zeros(MEMORY, np.int64), np.zeros(MEMORY), np.zeros(MEMORY, np.int64)),
            switches=np.zeros((MOST_SWITCHES, 4), np.int64),
            now=np.array([0, 1, 0, 0, 0]),
            of_human=np.full(MOST_HUMANS, NEVER),
            told=self.told,
            gamma=float(self.gamma),
            epsilon=float(self.epsilon),
            plan_every=self.plan_every,
            fill_unvisited=self.fills,
        )
        record.qs[0] = saved["q"]
        gather(record)
        return record

    @property
    def is_told(self) -> bool:
        """As declared."""
        return self.told

    def meet(self, record: Any, human: int) -> None:
        """Where it is told: go on with that human's model, or with a new one; the first human's is the trained one."""
        if not (self.told and isinstance(record, MultiModel)):
            return
        if record.of_human[human] == NEVER:
            new = human > 0 and record.now[MODELS] < MOST
            record.of_human[human] = record.now[MODELS] if new else 0 if human == 0 else record.now[ACTIVE]
        if record.of_human[human] != record.now[ACTIVE]:
            activate(record, int(record.of_human[human]), int(record.now[STEP]))

    def _forget_rewards(self, record: Any) -> None:
        """Of each model, for good."""
        if isinstance(record, ModelBased):
            super()._forget_rewards(record)
            return
        record.own.reward_sums[:] = 0.0
        gather(record)

    def _save(self, record: ModelBased | MultiModel) -> Saved:
        """Q and what it plans by; of several models also those of each, and the switches."""
        if isinstance(record, ModelBased):
            return super()._save(record)
        models = int(record.now[MODELS])
        states, actions = record.qs.shape[1:]
        own = saved_model(record.own, actions)
        pairs = models * states * actions
        kept = own["successor_offsets"][pairs]
        return {
            "q": record.qs[record.now[ACTIVE]],
            **saved_model(record.plan, actions),
            "models_q": record.qs[:models].reshape(-1, actions),
            "models_visits": own["visits"][: models * states],
            "models_reward_sums": own["reward_sums"][: models * states],
            "models_successor_offsets": own["successor_offsets"][: pairs + 1],
            "models_successor_states": own["successor_states"][:kept],
            "models_successor_counts": own["successor_counts"][:kept],
            "active": record.now[:1],
            "switches": record.switches[: record.now[SWITCHED]],
        }

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """As `save` has them."""
        q = floats(setting.n_states, setting.n_actions)
        if setting.task != VISIT:
            return super().arrays(setting)
        of_models = {
            name: array._replace(shape=(None, *array.shape[1:]))
            for name, array in declared_model(setting, "models_", weighted=True).items()
        }
        most = MOST * setting.n_states * setting.n_actions * setting.n_states
        offsets = counts(None, high=most, dtype="<i8")
        return {
            "q": q,
            **declared_model(setting, weighted=True),
            "models_q": floats(None, setting.n_actions),
            **of_models,
            "models_successor_offsets": offsets,
            "active": counts(1, high=MOST - 1, dtype="<i8"),
            "switches": counts(None, 4, high=2**62, dtype="<i8"),
        }

    def _fault(self, saved: Saved) -> str | None:
        """Whether the models are some, as many as there are values of."""
        fault = fault_in_model(model_arrays(saved))
        if fault or "active" not in saved:
            return fault
        n, (rest_of, rest) = len(saved["q"]), divmod(len(saved["models_q"]), len(saved["q"]))
        sizes = {len(saved[f"models_{name}"]) for name in ("q", "visits", "reward_sums")}
        if rest or sizes != {rest_of * n} or len(saved["models_successor_offsets"]) != saved["models_visits"].size + 1:
            return "its models are not all of one size"
        if saved["active"][0] >= rest_of:
            return f"the active model is none of the {rest_of}"
        step, before, after, since = saved["switches"].T
        if max(before.max(initial=0), after.max(initial=0)) >= rest_of:
            return f"a switch is between models of which one is none of the {rest_of}"
        if (np.diff(step) < 0).any() or (since > step).any():
            return "its switches do not lie one after the other"
        return fault_in_model(model_arrays(saved, "models_"))

    def models(self, saved: Saved) -> dict[str, Saved]:
        """Each by its number, the active one first, by its own counts alone; in training the only one."""
        if "active" not in saved:
            return {"model": model_arrays(saved)}
        n = len(saved["models_visits"]) // len(saved["q"])
        active = int(saved["active"][0])
        return {f"model {model}": _one_of(saved, model) for model in sorted(range(n), key=lambda each: each != active)}


def _one_of(saved: Saved, model: int) -> Saved:
    n, actions = saved["q"].shape
    rows = slice(model * n, (model + 1) * n)
    offsets = saved["models_successor_offsets"][model * n * actions : (model + 1) * n * actions + 1]
    seen = slice(offsets[0], offsets[-1])
    return dict(
        zip(
            ARRAYS,
            (
                saved["models_visits"][rows],
                saved["models_reward_sums"][rows],
                offsets - offsets[0],
                saved["models_successor_states"][seen],
                saved["models_successor_counts"][seen],
            ),
            strict=True,
        )
    )


def _padded(saved: Saved, models: int) -> Saved:
    """A saved model as the first of several in one, of which the others have seen nothing."""
    rows = (models * len(saved["visits"]), saved["visits"].shape[1])
    offsets = np.full(rows[0] * rows[1] + 1, saved["successor_offsets"][-1])
    offsets[: len(saved["successor_offsets"])] = saved["successor_offsets"]
    padded = {"successor_offsets": offsets, "successor_states": saved["successor_states"]}
    for name in ("visits", "reward_sums"):
        padded[name] = np.zeros(rows)
        padded[name][: len(saved[name])] = saved[name]
    return {**padded, "successor_counts": saved["successor_counts"].astype(np.float64)}


def _by_context(saved: Saved, context: Ints) -> Saved:
    """A saved model of states as one of contexts, with no rewards; nothing of 'go to human vision'.

    That teleports in training, and in a visit it does not.
    """
    actions = saved["visits"].shape[1]
    lengths = np.diff(saved["successor_offsets"])
    pairs = np.repeat(np.arange(len(lengths)), lengths)
    pairs = context[pairs // actions] * actions + pairs % actions
    told = pairs % actions != Action.GO_TO_HUMAN_VISION
    keys = (pairs * N_CONTEXTS + context[saved["successor_states"]])[told]
    found, place = np.unique(keys, return_inverse=True)
    weight = np.bincount(place, saved["successor_counts"][told], len(found))
    lengths = np.bincount(found // N_CONTEXTS, minlength=N_CONTEXTS * actions)
    return {
        "visits": np.bincount(found // N_CONTEXTS, weight, N_CONTEXTS * actions).reshape(-1, actions),
        "reward_sums": np.zeros((N_CONTEXTS, actions)),
        "successor_offsets": np.concatenate([[0], np.cumsum(lengths, dtype=np.int64)]),
        "successor_states": (found % N_CONTEXTS).astype(np.int32),
        "successor_counts": weight,
    }


@CHOOSE.of(MultiModel)
def choose(agent: MultiModel, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Epsilon-greedy by the active model."""
    return epsilon_greedy(agent.qs[agent.now[ACTIVE], state], agent.epsilon, random)


@CHOOSE_AS.of(MultiModel)
def choose_as(
    agent: MultiModel, state: int, meant: npt.NDArray[np.int64], step: int, random: RandomState
) -> tuple[int, bool]:
    """The same where each action is valued as the one it comes to."""
    return epsilon_greedy_as(agent.qs[agent.now[ACTIVE], state], meant, agent.epsilon, random)


@TELL.of(MultiModel)
def tell(agent: MultiModel, columns: StepColumns, row: int) -> None:
    """The active model, and the most that speaks for another one."""
    columns.active_model[row] = agent.now[ACTIVE]
    columns.evidence[row] = strongest_evidence(agent.detection.evidence)


@LEARN.of(MultiModel)
def learn(
    agent: MultiModel,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Judge and count the transition; sweep the active model's values at every `plan_every`-th step."""
    take_in(agent, state * agent.qs.shape[2] + action, reward, next_state)
    if agent.now[STEP] - agent.now[GATHERED] >= GATHER_EVERY:
        gather(agent)
    if step % agent.plan_every == 0:
        sweep(agent.plan, agent.qs[agent.now[ACTIVE]], agent.values, agent.gamma, 1, agent.fill_unvisited)
