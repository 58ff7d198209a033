"""The environments keep Gymnasium's promises, and are the tasks of TASK.md."""

import copy
import itertools
import os
import pickle
import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.error import InvalidAction, ResetNeeded
from gymnasium.utils.env_checker import check_env

import visitlab_cli.gym
from visitlab_cli.errors import UsageError
from visitlab_cli.world.enums import Action, InteractionLevel
from visitlab_cli.world.lab import make_lab, paper_lab

IDS = list(visitlab_cli.gym.ENVIRONMENTS)
NAVIGATION, GO_TO_HUMAN, SOCIAL, VISIT = IDS
MODULES = {"navigation": np.zeros((5184, 25)), "go_to_human": np.zeros((320, 25))}
"""Of a visit, where it is not about them: the exact ones take seconds to compute."""


def made(name, **settings):
    return gymnasium.make(name, **({"modules": MODULES} if name == VISIT else {}), **settings)


def episode(environment, actions, **reset):
    """All that an episode tells, until its time is up."""
    told = [environment.reset(**reset)]
    for action in actions:
        told.append(environment.step(action))
        if told[-1][3]:
            break
    return told


def actions_of(environment, count, seed=0):
    return np.random.default_rng(seed).integers(environment.action_space.n, size=count).tolist()


def with_scene(name, seed, **settings):
    """An episode as rows: the whole scene after each step, with `state`, `reward` and the dict observation."""
    states, parts = made(name, full_info=True, **settings), made(name, observation="dict", **settings)
    actions = actions_of(states, 100, seed)
    rows = []
    for (state, *rest), (seen, *_) in zip(
        episode(states, actions, seed=seed), episode(parts, actions, seed=seed), strict=True
    ):
        rows.append({**rest[-1], "state": state, "reward": rest[0] if len(rest) > 1 else 0.0, "seen": seen})
    return rows


@pytest.mark.parametrize("observation", ["state", "dict"])
@pytest.mark.parametrize("name", IDS)
def test_gymnasium_finds_nothing_to_say(name, observation):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(made(name, observation=observation).unwrapped, skip_render_check=True)


def test_either_way_of_making_one_in_a_new_process():
    code = "import gymnasium; print(gymnasium.make('visitlab_cli.gym:visitlab/Social-v0').reset(seed=1)[0])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(done.stdout) == made(SOCIAL).reset(seed=1)[0]


def test_without_gymnasium_one_line_says_what_to_install():
    code = "import sys; sys.modules['gymnasium'] = None\nimport visitlab_cli.gym"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.count("Traceback") == 1
    assert done.stderr.splitlines()[-1].endswith(
        'NoGymnasiumError: visitlab_cli.gym needs Gymnasium: pip install "visitlab[gymnasium]"'
    )


@pytest.mark.parametrize("name", IDS)
def test_the_same_seed_is_the_same_episode_and_without_one_the_stream_goes_on(name):
    environment, actions = made(name), actions_of(made(name), 200)
    first, second = episode(environment, actions, seed=7), episode(environment, actions)
    other = made(name)
    assert first == episode(other, actions, seed=7)
    assert second == episode(other, actions)
    assert first != second
    assert first != episode(other, actions, seed=8)
    assert first == episode(other, actions, seed=7)


def test_seeds_of_a_generator_that_is_given():
    one, two = made(SOCIAL), made(SOCIAL)
    for environment in (one, two):
        environment.unwrapped.np_random = np.random.default_rng(5)
    assert one.reset() == two.reset()
    assert one.unwrapped.np_random_seed == -1


@pytest.mark.parametrize(("name", "steps"), [(NAVIGATION, 20), (GO_TO_HUMAN, 20), (SOCIAL, 20), (VISIT, 100)])
def test_only_the_time_ends_an_episode(name, steps):
    for settings, length in (({}, steps), ({"trial_steps": 3}, 3)):
        environment = made(name, **settings)
        told = episode(environment, actions_of(environment, 200), seed=1)
        assert [step[2:4] for step in told[1:]] == [(False, False)] * (length - 1) + [(False, True)]
        with pytest.raises(ResetNeeded):
            environment.step(0)


@pytest.mark.parametrize("name", IDS)
def test_the_state_is_that_of_the_parts(name):
    """TASK.md, 'The four tasks': the numbers of states."""
    for row in with_scene(name, 3):
        seen = {key: value.tolist() for key, value in row["seen"].items()}
        if name == NAVIGATION:
            assert row["state"] == seen["goal_room"] * 576 + seen["cells"][0] * 24 + seen["cells"][1]
        elif name == GO_TO_HUMAN:
            assert row["state"] == seen["angle"] + 8 * (seen["headings"][1] + 8 * seen["distance"])
        else:
            expected = seen["level"] + 8 * (seen["distance"] + 5 * (seen["direction"] + 8 * seen["angle"]))
            assert row["state"] == expected
        assert seen["cells"][:2] == [row["robot_row"], row["robot_col"]]
        if name != NAVIGATION:
            assert seen["cells"][2:] == [row["human_row"], row["human_col"]]
            assert seen["headings"] == [row["robot_heading"], row["human_heading"]]


def test_what_was_just_reached_in_a_visit():
    rows = [row for seed in range(40) for row in with_scene(VISIT, seed, human="human_1")]
    told = set()
    for before, after in itertools.pairwise(rows):
        if after["executed_action"] == Action.NO_ACTION:
            assert (after["level_reached"], after["goal_reached"], after["social_reward"]) == (-1, -1, 0.0)
            continue
        rose = after["interaction_level"] > before["interaction_level"]
        assert after["level_reached"] == (after["interaction_level"] if rose else -1)
        in_goal = paper_lab().rooms[after["human_row"], after["human_col"]] == before["goal_room"]
        assert after["reward"] == in_goal
        assert after["goal_reached"] == (before["goal_room"] if in_goal else -1)
        assert (after["goal_room"] != before["goal_room"]) == in_goal
        told |= {after["level_reached"], "goal" if in_goal else "none"}
    assert {"goal", "none", InteractionLevel.GREETED} <= told


def test_a_goal_room_is_reached_when_it_is_entered():
    reached = []
    for seed in range(20):
        rows = with_scene(NAVIGATION, seed)
        rewards = [row["reward"] for row in rows]
        for step, row in enumerate(rows[1:], 1):
            entered = rewards[step] == 1 and rewards[step - 1] == 0
            assert row["goal_reached"] == (row["goal_room"] if entered else -1)
            reached.append(entered)
    assert any(reached)


def test_goals_carry_over_to_the_next_episode_of_a_visit():
    environment = made(VISIT, full_info=True)
    last = episode(environment, actions_of(environment, 200), seed=2)[-1][-1]
    _, info = environment.reset()
    assert info["goal_room"] == last["goal_room"]


def test_humans_by_name_by_parameters_and_as_records():
    numbers = {"p_S": [0, 0.5, 0.5], "p_H": 0.05, "p_M": 0.05, "p_O": 0.15, "p_A": 0.05}
    from visitlab_cli.humans.six_parameters import SixParameters

    parameters = SixParameters(**{**numbers, "p_S": (0, 0.5, 0.5)})
    same = ["human_2", numbers, {"like": "human_2"}, {"like": "human_1"} | numbers, parameters, parameters.create()]
    played = [episode(made(SOCIAL, human=human), actions_of(made(SOCIAL), 20), seed=4) for human in same]
    assert all(each == played[0] for each in played)
    restless = {"p_S": [0, 0, 1], "p_M": 1}
    assert episode(made(SOCIAL, human=restless), actions_of(made(SOCIAL), 20), seed=4) != played[0]


def test_a_lab_of_ones_own():
    """A wall without a door between two rooms: nobody changes sides, and the state has fewer goal rooms."""
    rooms = np.repeat([[0, 1]], 4, axis=0).repeat(3, axis=1)
    lab = make_lab(4, 6, walls=[((row, 2), (row, 3)) for row in range(4)], rooms=rooms)
    environment = gymnasium.make(NAVIGATION, lab=lab, observation="dict", trial_steps=50)
    assert gymnasium.make(NAVIGATION, lab=lab).observation_space.n == 2 * 24
    for seed in range(4):
        told = episode(environment, actions_of(environment, 50, seed), seed=seed)
        assert len({int(rooms[tuple(seen["cells"])]) for seen, *_ in told}) == 1
    assert environment.unwrapped.P.shape == (48, 25)


@pytest.mark.parametrize("again", [copy.deepcopy, lambda environment: pickle.loads(pickle.dumps(environment))])
def test_a_copy_has_the_same_future_and_leaves_the_original_alone(again):
    environment = made(SOCIAL).unwrapped
    actions = actions_of(environment, 40)
    episode(environment, actions[:5], seed=1)
    other, third = again(environment), again(environment)
    assert [other.step(action) for action in actions[5:20]] == [environment.step(action) for action in actions[5:20]]
    assert episode(other, actions) == episode(environment, actions)
    assert third.step(actions[5])[3] is False


@pytest.mark.parametrize(
    ("name", "settings", "line"),
    [
        (SOCIAL, {"human": "human_9"}, "human='human_9': no shipped human is called so; did you mean human_3?"),
        (SOCIAL, {"human": {"p_S": [1, 1, 0]}}, "human.p_S: must sum to 1 (sums to 2)"),
        (SOCIAL, {"trial_steps": 0}, "trial_steps: must be at least 1 (got 0)"),
        (SOCIAL, {"arena": 1, "direction_change": 2}, "arena: must be at least 2 (got 1)\ndirection_change: must be"),
        (VISIT, {"goal_rooms": [1]}, "goal_rooms: must have at least 2 entries (got 1)"),
        (GO_TO_HUMAN, {"success": "glance"}, "success: must be facing or seen (got 'glance')"),
        (NAVIGATION, {"observation": "dct"}, "observation='dct': there is none; did you mean dict?"),
        (NAVIGATION, {"full_info": "x"}, "full_info='x': must be True or False"),
        (VISIT, {"goal_rooms": None}, "goal_rooms: must be all or a list of rooms (got nothing)"),
        (SOCIAL, {"distances": None}, "distances: must be a list (got nothing)"),
    ],
)
def test_wrong_settings_are_told_as_a_configs_are(name, settings, line):
    with pytest.raises(UsageError) as error:
        made(name, **settings)
    assert str(error.value).startswith(line)


@pytest.mark.parametrize(
    ("table", "got"), [(np.zeros((3, 25)), r"\(3, 25\)"), (np.full((5184, 25), np.nan), "some that are not finite")]
)
def test_modules_that_are_no_tables_of_finite_numbers(table, got):
    told = rf"^modules: the Q of navigation must be finite numbers of shape \(5184, 25\) \(got {got}\)$"
    with pytest.raises(UsageError, match=told):
        gymnasium.make(VISIT, modules={"navigation": table})


def test_modules_that_are_no_mapping():
    with pytest.raises(UsageError, match=r"^modules: must be a mapping, .* \(got 3\)$"):
        gymnasium.make(VISIT, modules=3)


def test_a_map_of_one_row_is_a_lab():
    assert made(NAVIGATION, lab="ab\n").unwrapped.lab.n_rooms == 2


def test_wrong_calls():
    environment = made(SOCIAL)
    with pytest.raises(ResetNeeded):
        environment.step(0)
    environment.reset(seed=0)
    for action in (-1, 30, 1.5, "1", None):
        with pytest.raises(InvalidAction, match=f"action {action}: must be from 0 to 29"):
            environment.step(action)
    with pytest.raises(UsageError, match="no option 'cel'; did you mean cell"):
        environment.reset(options={"cel": "social/mf/human_2/seed-0000"})
    for cell in ("x", 3, "", "seed-0000", "social/mf/human_2", "../social/seed-0000", ["social/mf/seed-0000"]):
        with pytest.raises(UsageError, match="must be a cell's path, such as social/mb/human_2/seed-0000"):
            environment.reset(seed=0, options={"cell": cell})
    with pytest.raises(UsageError, match="needs its config's seed"):
        environment.reset(options={"cell": "social/mf/human_2/seed-0000"})


PLAYED = """
import gymnasium, numpy as np, visitlab_cli.gym
from visitlab_cli.compiled import JIT_DISABLED
modules = {"navigation": np.arange(5184 * 25.0).reshape(5184, 25) % 7, "go_to_human": np.zeros((320, 25))}
print(JIT_DISABLED)
for name in visitlab_cli.gym.ENVIRONMENTS:
    more = {"modules": modules} if "Visit" in name else {}
    one = gymnasium.make(name, full_info=True, **more)
    told = [one.reset(seed=3), *(one.step(action) for action in range(20))]
    lanes = gymnasium.make_vec(name, num_envs=3, trial_steps=5, **more)
    told += [lanes.reset(seed=3)[0].tolist(), *(lanes.step([action] * 3)[0].tolist() for action in range(20))]
    print(told)
"""


@pytest.mark.slow
def test_without_the_compiler_all_is_the_same():
    played = [
        subprocess.run(
            [sys.executable, "-c", PLAYED],
            env=os.environ | {"NUMBA_DISABLE_JIT": switched_off},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.splitlines()
        for switched_off in ("0", "1")
    ]
    (compiled, *as_compiled), (plain, *as_plain) = played
    assert (compiled, plain) == ("False", "True")
    assert as_plain == as_compiled
