"""The models of an agent that has several, at each step: judged by how well they foretold it, counted, switched.

`evidence` is a CUSUM for each model, and one for a candidate that has learned since it last began anew (Alegre,
Bazzan and da Silva 2021, with a real candidate). At a switch the steps since the change are taken from the old model
and given to the new one (Chartouny, Khamassi and Girard 2025).
"""

import math
from typing import NamedTuple

import numpy as np

from visitlab_cli.agents.exploration import Table
from visitlab_cli.agents.sparse_model import MOST_OF_ONE, Ints, SparseModel, count, follow, sweep, times, uncount
from visitlab_cli.compiled import kernel, long_kernel
from visitlab_cli.world.enums import N_DIRECTIONS, N_DISTANCES, N_LEVELS, Action
from visitlab_cli.world.social import parts_of

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


def contexts(states: int) -> Ints:
    """The (level, distance, angle) of social states, as one number."""
    parts = parts_of(np.arange(states))
    context: Ints = (parts.level * N_DISTANCES + parts.distance) * N_DIRECTIONS + parts.angle
    return context


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
def strongest_evidence(evidence: Table) -> float:
    """The most that speaks for another model, or a new one."""
    return float(max(evidence[_strongest(evidence)], evidence[CANDIDATE], 0.0))


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
