"""Agents that learn states which symmetry makes the same as one."""

import re

import numpy as np
import pytest
from pydantic import TypeAdapter

from tests.program import hashes, the_run, visitlab
from visitlab_cli.agents.base import Setting, choose, learn
from visitlab_cli.agents.registry import KINDS as AGENTS
from visitlab_cli.agents.registry import AnyAgent
from visitlab_cli.agents.symmetry import fault_in_fold, fold, folded, unfolded
from visitlab_cli.agents.tabular import TabularParameters
from visitlab_cli.compiled import kernel
from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.loading import load
from visitlab_cli.errors import ConfigError
from visitlab_cli.random_numbers import random_state
from visitlab_cli.world.social import parts_of

SETTING = Setting("social", 2560, 30, 2000)
KINDS = [
    {"kind": "q_learning", "symmetric": True},
    {"kind": "model_based", "symmetric": True, "unvisited": "zero", "plan_every": 7},
    {"kind": "model_based", "symmetric": True, "exploration": "count_bonus", "bonus": 0.5, "plan_every": 7},
    {"kind": "rmax", "symmetric": True, "plan_every": 7},
    {"kind": "windowed", "symmetric": True, "unvisited": "zero", "plan_every": 7, "k": 2},
    {"kind": "coordinated", "symmetric": True, "unvisited": "zero", "plan_every": 7},
]


def made(settings):
    return TypeAdapter(AnyAgent).validate_python(settings)


def image(symmetry, states, actions):
    """States and moves turned by hand: the lab mirrored at its west-east line, then turned by quarters."""
    quarter, mirrored = symmetry

    def to(direction):
        return ((8 - direction if mirrored else direction) + 2 * quarter) % 8

    level, distance, desired, angle = parts_of(states)
    moved = np.where(actions < 24, actions // 8 * 8 + to(actions % 8), actions)
    return level + 8 * (distance + 5 * (to(desired) + 8 * to(angle))), moved


def test_a_state_and_its_actions_become_an_image_of_theirs_the_same_for_all_images():
    now = fold()
    assert len(now.kept) == 400
    states, actions = np.arange(2560)[:, None], np.arange(30)[None, :]
    images = [image((quarter, mirrored), states, actions) for quarter in range(4) for mirrored in (False, True)]
    stands = now.kept[now.state]
    is_image = np.zeros(2560, bool)
    for state, action in images:
        assert (now.state[state[:, 0]] == now.state).all()
        is_image |= (state[:, 0] == stands) & (action == now.action).all(axis=1)
        place, least = parts_of(state[:, 0]), parts_of(stands)
        assert (8 * place.angle + place.desired_direction >= 8 * least.angle + least.desired_direction).all()
    assert is_image.all()
    assert (np.take_along_axis(now.action, now.back, axis=1) == np.arange(30)).all()


@kernel
def play(agent, steps, random):
    state = 0
    for step in range(1, steps + 1):
        action, _ = choose(agent, state, step, random)
        following = (state * 31 + action * 7 + step) % 2560
        learn(agent, state, action, 1.0 if step % 3 == 0 else 0.0, following, step % 20 == 0, step, random)
        state = following


@pytest.mark.parametrize("settings", KINDS, ids=[each["kind"] for each in KINDS])
def test_it_saves_what_is_symmetric_and_goes_on_as_it_would_have(settings):
    agent = made(settings)
    whole, halves = agent.create(SETTING), agent.create(SETTING)
    random, again = random_state(0, "a"), random_state(0, "a")
    play(whole, 300, random)
    play(halves, 300, again)
    saved = agent.save(halves)
    assert {name: array.shape for name, array in saved.items() if array.ndim == 2} == {
        name: (2560, 1 if name == "agreement" else 30) for name, array in saved.items() if array.ndim == 2
    }
    assert saved["visits"].sum() == 300 or settings["kind"] in ("rmax", "windowed")  # these count less
    assert agent.fault(SETTING, saved) is None
    halves = agent.restore(SETTING, saved)
    play(whole, 300, random)
    play(halves, 300, again)
    one, other = agent.save(whole), agent.save(halves)
    assert all(np.array_equal(one[name], other[name]) for name in one)
    now = fold()
    assert all(
        np.array_equal(one["q"][state], one["q"][now.kept[now.state[state]]][now.action[state]])
        for state in range(0, 2560, 37)
    )


def test_what_is_not_symmetric_is_refused():
    plain = made({"kind": "model_based", "unvisited": "zero", "plan_every": 7})
    record = plain.create(SETTING)
    play(record, 300, random_state(0, "a"))
    saved = plain.save(record)
    assert fault_in_fold(saved) is not None
    assert made(KINDS[1]).fault(SETTING, saved) is not None
    inner = folded(saved)
    assert fault_in_fold(unfolded(inner)) is None


CONFIG = """
name: mirror
humans: {h: {p_S: [0, 0.5, 0.5], p_A: 0.05}}
agents:
  mirror: {kind: model_based, symmetric: true, unvisited: zero}
  plain: {kind: model_based, unvisited: zero}
  q: {kind: q_learning, symmetric: true}
  watching: {kind: observer, watches: mirror, learner: q, until: 10, acts_as: q}
experiments:
  navigation: {task: navigation, agents: [AGENT], steps: 200}
  go: {task: go_to_human, agents: [plain], steps: 200}
  social: {task: social, agents: [mirror, plain], humans: [h], steps: STEPS}
  again: {task: social, agents: [mirror], humans: [h], steps: 2000, start_from: social/FROM/h}
  visit:
    task: visit
    modules: {navigation: navigation/plain, go_to_human: go/plain, social: social/mirror}
    humans: [h]
    trials: 3
"""


def config(agent="plain", start="mirror", steps=1000, watching=False):
    text = CONFIG.replace("AGENT", agent).replace("FROM", start).replace("STEPS", str(steps))
    return text if watching else "".join(line for line in text.splitlines(True) if "watching" not in line)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (config(agent="mirror"), "mirror cannot play navigation; it plays social, visit"),
        (config(start="plain"), "mirror can't go on from plain: of the two only one is symmetric"),
        (config(watching=True), "q must not be symmetric"),
        (config().replace("symmetric: true, unvisited: zero", "symmetric: true"), "unvisited: zero"),
    ],
)
def test_a_config_that_asks_too_much_is_told(text, told, tmp_path):
    (tmp_path / "mirror.yaml").write_text(text)
    with pytest.raises(ConfigError, match=re.escape(told)):
        load(tmp_path / "mirror.yaml")


@pytest.mark.parametrize("word", sorted(AGENTS))
def test_a_kind_has_the_setting_where_it_can_take_it_and_only_there(word, tmp_path):
    kind = AGENTS[word]
    if "symmetric" in kind.model_fields:
        zero = {"unvisited": "zero"} if "unvisited" in kind.model_fields else {}
        assert kind(kind=word, symmetric=True, **zero).symmetric
    elif issubclass(kind, TabularParameters):
        file = tmp_path / "mirror.yaml"
        text = config().replace("kind: q_learning, symmetric: true", f"kind: {word}, symmetric: WHETHER")
        file.write_text(text.replace("WHETHER", "true"))
        with pytest.raises(ConfigError, match=f"agents.q.symmetric: unknown of this kind: {kind.never['symmetric']}"):
            load(file)
        hashes = set()
        for told in (text.replace("WHETHER", "false"), text.replace(", symmetric: WHETHER", "")):
            file.write_text(told)  # the first is what a run's config said that was made before
            hashes.add(config_hash(load(file)))
        assert len(hashes) == 1


@pytest.mark.slow
def test_it_is_trained_gone_on_from_visited_frozen_and_verified(tmp_path):
    (tmp_path / "mirror.yaml").write_text(config())
    done = visitlab("run", tmp_path / "mirror.yaml", "--out", tmp_path / "runs", "--workers", 1)
    assert done.returncode == 0, done.stderr
    run = the_run(tmp_path / "runs")
    trained = hashes(run)
    for command in (["runs", "verify", run], ["eval", run, "--frozen", "--trials", 2], ["affordances", run]):
        done = visitlab(*command)
        assert done.returncode == 0, (command, done.stderr)
    model = np.load(run / "social/mirror/h/seed-0000/model.npz")
    assert fault_in_fold({name: model[name] for name in model.files if name != "random_state"}) is None
    uncompiled = {"NUMBA_DISABLE_JIT": "1"}
    done = visitlab("run", tmp_path / "mirror.yaml", "--out", tmp_path / "slow", "--workers", 1, env=uncompiled)
    assert done.returncode == 0, done.stderr
    assert hashes(the_run(tmp_path / "slow")) == trained
