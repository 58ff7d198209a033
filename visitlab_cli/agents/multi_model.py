"""Several models of the world, one for each kind of human that was met, over what they have in common.

Each model has its own counts; the active one plans by these and by those of the others together, as a prior. It is
never told who comes: whether another human is there is judged at each step, before it is counted, by how well each
model foretold the change of (level, distance, angle): a CUSUM for each model, and one for a candidate that has learned
since it last began anew (Alegre, Bazzan and da Silva 2021, with a real candidate). The desired direction is summed
out, for it is not the human's. At a switch the steps since the change are taken from the old model and given to the
new one (Chartouny, Khamassi and Girard 2025).
"""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Literal, NamedTuple, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, LEARN, TELL, Saved, Setting, zeros
from visitlab_cli.agents.declared import Declared, counts, fault_in_model, floats
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as
from visitlab_cli.agents.model_based import ModelBased
from visitlab_cli.agents.sparse_model import (
    ARRAYS,
    MOST_OF_ONE,
    Ints,
    SparseModel,
    count,
    declared_model,
    empty_model,
    follow,
    model_arrays,
    restored_model,
    saved_model,
    sweep,
    times,
    uncount,
)
from visitlab_cli.agents.swept import SweptParameters
from visitlab_cli.compiled import kernel, long_kernel
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.settings import since
from visitlab_cli.world.columns import MODELS as MODELS_PART
from visitlab_cli.world.columns import StepColumns
from visitlab_cli.world.enums import N_DIRECTIONS, N_DISTANCES, N_LEVELS, Action
from visitlab_cli.world.social import parts_of
from visitlab_cli.world.tasks import SOCIAL, VISIT

MOST = 8
"""Models."""
CANDIDATE = MOST
N_CONTEXTS = N_LEVELS * N_DISTANCES * N_DIRECTIONS
UNSEEN = 1.0
"""As how many steps the general model's belief that any context follows counts."""
STRENGTH = 20.0
"""As how many visits to a pair what the others have in common counts, at most."""
CLIP, SWITCH, NEW, GIVEN_UP = 3.0, 30.0, 80.0, -15.0
"""Evidence, in nats: of a step at most, for a model that is there, for a new one, for beginning the candidate anew."""
MEMORY = 3000
"""Steps after which the candidate begins anew, so that no more can be given to another model."""
GATHER_EVERY = 5000
"""Steps after which what the others have in common is gathered anew."""
SWEEPS = 20
"""At a switch."""
MOST_SWITCHES = 10_000
MOST_HUMANS = 100
NEVER = -1


class Journal(NamedTuple):
    """The last steps, in rings of `MEMORY`."""

    pairs: Ints
    rewards: Table
    next_states: Ints


class Detection(NamedTuple):
    """`model` counts by context and action, of models and the candidate, one after the other."""

    context: Ints  # of a state, shape (states,)
    model: SparseModel
    evidence: Table  # of each model, and last of the candidate, against the active one
    begun: Ints  # the last step at which that was nothing


class MultiModel(NamedTuple):
    """`qs` has shape (models, states, actions); `own` has the pairs of one model after those of another.

    `plan` is the active model with what the others have in common.
    """

    qs: Table
    values: Table
    own: SparseModel
    plan: SparseModel
    detection: Detection
    journal: Journal
    switches: Ints  # rows of the agent's step, from which model, to which, and after which step that one holds
    now: Ints  # the active model, how many there are, the step, when `plan` was gathered, the number of switches
    of_human: Ints  # the model of each human, for one that is told who comes
    told: bool
    gamma: float
    epsilon: float
    plan_every: int
    fill_unvisited: bool


ACTIVE, MODELS, STEP, GATHERED, SWITCHED = range(5)
"""Places in `now`."""


class MultiModelParameters(SweptParameters):
    """In a visit a model for each kind of human that it meets; in training it is model_based."""

    pools: ClassVar[bool] = True
    takes_masks: ClassVar[bool] = True
    parts: ClassVar[tuple[str, ...]] = (MODELS_PART,)
    tasks: ClassVar[tuple[str, ...]] = (SOCIAL, VISIT)
    microseconds_a_step: ClassVar[Mapping[str, float]] = {SOCIAL: 5.3, VISIT: 30.0}
    kind: Literal["multi_model"]
    told: bool = Field(
        default=False,
        description="whether it is told when another human comes, and who of those it met; else it finds out",
        json_schema_extra=since("0.2.0"),
    )

    @model_validator(mode="after")
    def _of_all_states(self) -> Self:
        if self.symmetric:
            raise ValueError("symmetric is not for several models")
        return self

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
        return fault_in_model(model_arrays(saved, "models_"))

    def models(self, saved: Saved) -> dict[str, Saved]:
        """Each by its number, the active one first, by its own counts alone; in training the only one."""
        if "active" not in saved:
            return {"model": model_arrays(saved)}
        n = len(saved["models_visits"]) // len(saved["q"])
        active = int(saved["active"][0])
        return {f"model {model}": _one_of(saved, model) for model in sorted(range(n), key=lambda each: each != active)}


def contexts(states: int) -> Ints:
    """The (level, distance, angle) of social states, as one number."""
    parts = parts_of(np.arange(states))
    context: Ints = (parts.level * N_DISTANCES + parts.distance) * N_DIRECTIONS + parts.angle
    return context


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


@long_kernel
def gather(agent: MultiModel) -> None:
    """Lay out what the active model plans by: its own counts, and those of the others as a prior.

    Of the others each n(s, a) counts as min(n, 100), all together as `STRENGTH` at most.
    """
    own, plan, active = agent.own, agent.plan, agent.now[ACTIVE]
    pairs = len(plan.visits)
    plan.pool_end[0] = 0
    for pair in range(pairs):
        plan.room[pair] = plan.length[pair] = 0
        others = 0.0
        for model in range(agent.now[MODELS]):
            if model != active:
                others += min(own.visits[model * pairs + pair], MOST_OF_ONE)
        visits, rewards = 0.0, 0.0
        for model in range(agent.now[MODELS]):
            row = model * pairs + pair
            n = own.visits[row]
            if n <= 0.0:
                continue
            share = 1.0 if model == active else min(others, STRENGTH) / others * min(n, MOST_OF_ONE) / n
            visits += share * n
            rewards += share * own.reward_sums[row]
            for place in range(own.first[row], own.first[row] + own.length[row]):
                follow(plan, pair, own.pool_states[place], share * own.pool_counts[place])
        plan.visits[pair] = visits
        plan.reward_sums[pair] = rewards
        plan.mean_rewards[pair] = rewards / visits if visits > 0.0 else 0.0
    agent.now[GATHERED] = agent.now[STEP]


@long_kernel
def judge(agent: MultiModel, pair: int, context: int) -> None:
    """Weigh each model, and the candidate, against the active one by how it foretold what followed a context's pair."""
    detection, n_models = agent.detection, agent.now[MODELS]
    seen, pairs = detection.model, len(detection.model.visits) // (MOST + 1)
    likely, known = UNSEEN / N_CONTEXTS, UNSEEN
    for model in range(n_models):
        n = seen.visits[model * pairs + pair]
        if n > 0.0:
            share = min(1.0, MOST_OF_ONE / n)
            likely += share * times(seen, model * pairs + pair, context)
            known += share * n
    likely /= known
    active = math.log(_foretold(seen, agent.now[ACTIVE] * pairs + pair, context, likely))
    for model in range(n_models):
        if model != agent.now[ACTIVE]:
            gain = math.log(_foretold(seen, model * pairs + pair, context, likely)) - active
            detection.evidence[model] = max(0.0, detection.evidence[model] + min(max(gain, -CLIP), CLIP))
            if detection.evidence[model] == 0.0:
                detection.begun[model] = agent.now[STEP]
    gain = math.log(_foretold(seen, CANDIDATE * pairs + pair, context, likely)) - active
    detection.evidence[CANDIDATE] += min(max(gain, -CLIP), CLIP)


@kernel
def _foretold(seen: SparseModel, row: int, context: int, likely: float) -> float:
    """The probability that a model gave to what followed, with the general model's `likely` as a prior."""
    return float((times(seen, row, context) + STRENGTH * likely) / (seen.visits[row] + STRENGTH))


@kernel
def _strongest(evidence: Table) -> int:
    """The model for which most speaks; the active one, for which nothing does, where nothing speaks for any."""
    best = 0
    for model in range(1, MOST):
        if evidence[model] > evidence[best]:
            best = model
    return best


@kernel
def _place(step: int) -> int:
    return (step - 1) % MEMORY


@long_kernel
def begin_candidate(agent: MultiModel) -> None:
    """Let the candidate forget all that it has seen."""
    detection, journal = agent.detection, agent.journal
    pairs, actions = len(detection.model.visits) // (MOST + 1), agent.qs.shape[2]
    for step in range(detection.begun[CANDIDATE] + 1, agent.now[STEP] + 1):
        pair = journal.pairs[_place(step)]
        row = CANDIDATE * pairs + detection.context[pair // actions] * actions + pair % actions
        detection.model.visits[row] = 0.0
        detection.model.length[row] = 0
    detection.evidence[CANDIDATE] = 0.0
    detection.begun[CANDIDATE] = agent.now[STEP]


@long_kernel
def activate(agent: MultiModel, model: int, since: int) -> None:
    """Go on with a model, with a new one where there is none of its number, as if it had been active after `since`."""
    detection, journal, before = agent.detection, agent.journal, agent.now[ACTIVE]
    pairs, actions = len(agent.plan.visits), agent.qs.shape[2]
    of_context = len(detection.model.visits) // (MOST + 1)
    if model == agent.now[MODELS]:
        agent.now[MODELS] += 1
        for state in range(agent.qs.shape[1]):
            for action in range(actions):
                agent.qs[model, state, action] = agent.qs[before, state, action]
    for step in range(max(since, agent.now[STEP] - MEMORY) + 1, agent.now[STEP] + 1):
        place = _place(step)
        pair, reward, next_state = journal.pairs[place], journal.rewards[place], journal.next_states[place]
        uncount(agent.own, before * pairs + pair, reward, next_state)
        count(agent.own, model * pairs + pair, reward, next_state)
        if pair % actions != Action.GO_TO_HUMAN_VISION:
            row = detection.context[pair // actions] * actions + pair % actions
            uncount(detection.model, before * of_context + row, 0.0, detection.context[next_state])
            count(detection.model, model * of_context + row, 0.0, detection.context[next_state])
    if agent.now[SWITCHED] < MOST_SWITCHES:
        agent.switches[agent.now[SWITCHED], 0] = agent.now[STEP]
        agent.switches[agent.now[SWITCHED], 1] = before
        agent.switches[agent.now[SWITCHED], 2] = model
        agent.switches[agent.now[SWITCHED], 3] = since
        agent.now[SWITCHED] += 1
    agent.now[ACTIVE] = model
    begin_candidate(agent)
    detection.evidence[:] = 0.0
    detection.begun[:] = agent.now[STEP]
    gather(agent)
    for _ in range(SWEEPS):
        sweep(agent.plan, agent.qs[model], agent.values, agent.gamma, 1, agent.fill_unvisited)


@long_kernel
def take_in(agent: MultiModel, pair: int, reward: float, next_state: int) -> None:
    """Judge a transition, count it for the active model, and go on with another where the evidence is enough."""
    detection, actions = agent.detection, agent.qs.shape[2]
    pairs, of_context = len(agent.plan.visits), len(detection.model.visits) // (MOST + 1)
    if agent.now[STEP] - detection.begun[CANDIDATE] >= MEMORY:  # before its first step leaves the journal
        begin_candidate(agent)
    agent.now[STEP] += 1
    context = detection.context[next_state]
    row = detection.context[pair // actions] * actions + pair % actions
    detects = pair % actions != Action.GO_TO_HUMAN_VISION and not agent.told
    if detects:
        judge(agent, row, context)
        count(detection.model, CANDIDATE * of_context + row, 0.0, context)
        count(detection.model, agent.now[ACTIVE] * of_context + row, 0.0, context)
    journal, place = agent.journal, _place(agent.now[STEP])
    journal.pairs[place], journal.rewards[place], journal.next_states[place] = pair, reward, next_state
    count(agent.own, agent.now[ACTIVE] * pairs + pair, reward, next_state)
    count(agent.plan, pair, reward, next_state)
    if not detects:
        return
    best = _strongest(detection.evidence)
    if detection.evidence[best] > SWITCH:
        activate(agent, best, detection.begun[best])
    elif detection.evidence[CANDIDATE] > NEW and agent.now[MODELS] < MOST:
        activate(agent, agent.now[MODELS], detection.begun[CANDIDATE])
    elif detection.evidence[CANDIDATE] < GIVEN_UP:
        begin_candidate(agent)


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
    evidence = agent.detection.evidence
    columns.evidence[row] = max(evidence[_strongest(evidence)], evidence[CANDIDATE], 0.0)


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
