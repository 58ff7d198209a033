"""Steps a second through Gymnasium on one core, as a user's loop has them: one environment, and lanes.

    python -m benchmarks.environments

Actions are drawn beforehand. Of one environment the loop's own work (a call, a tuple, the test for an episode's end)
is in the figure.
"""

import time

from benchmarks.rows import Row, number, show

LANES = 1024
SINGLE_STEPS, LANE_STEPS = 200_000, 400
CASES = {  # (environment, keywords): (wanted of one, wanted of the lanes)
    ("Navigation-v0", ()): (None, None),
    ("GoToHuman-v0", ()): (None, None),
    ("Social-v0", ()): (140_000, 4_000_000),
    ("Social-v0", (("full_info", True),)): (None, None),
    ("Social-v0", (("observation", "dict"),)): (None, None),
    ("Visit-v0", ()): (None, None),
}
REPETITIONS = 3


def single(name, keywords):
    """Steps a second of one environment, episodes begun anew."""
    import gymnasium
    import numpy as np

    environment = gymnasium.make(f"visitlab/{name}", **keywords)
    actions = np.random.default_rng(0).integers(environment.action_space.n, size=SINGLE_STEPS)
    environment.reset(seed=0)
    environment.step(actions[0])
    begun = time.perf_counter()
    for action in actions:
        _, _, terminated, truncated, _ = environment.step(action)
        if terminated or truncated:
            environment.reset()
    return SINGLE_STEPS / (time.perf_counter() - begun)


def lanes(name, keywords):
    """Steps a second of many lanes."""
    import gymnasium
    import numpy as np

    environments = gymnasium.make_vec(f"visitlab/{name}", num_envs=LANES, **keywords)
    n_actions = environments.single_action_space.n
    actions = np.random.default_rng(0).integers(n_actions, size=(LANE_STEPS, LANES))
    environments.reset(seed=0)
    environments.step(actions[0])
    begun = time.perf_counter()
    for each in actions:
        environments.step(each)
    return LANES * LANE_STEPS / (time.perf_counter() - begun)


def rows():
    import visitlab_cli.gym  # noqa: F401  (it registers)

    for (name, pairs), (of_one, of_lanes) in CASES.items():
        keywords = dict(pairs)
        fast = max(single(name, keywords) for _ in range(REPETITIONS))
        many = max(lanes(name, keywords) for _ in range(REPETITIONS))
        words = " ".join([name, *(f"{key}={value}" for key, value in pairs)])
        yield Row(f"Gymnasium, {words}, one environment", fast, "steps/s", wanted=f"{of_one:,}" if of_one else "")
        beside = f"one {number(fast)}"
        wanted = f"{of_lanes:,}" if of_lanes else ""
        yield Row(f"Gymnasium, {words}, {LANES:,} lanes", many, "steps/s", beside, many / fast, wanted)


if __name__ == "__main__":
    show(rows())
