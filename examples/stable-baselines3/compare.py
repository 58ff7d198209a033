"""Stable-Baselines3's PPO beside visitlab's agents: the same task, steps, seeds and measure, as a table.

python compare.py --help
"""

import argparse
import time
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import torch
from lanes import SocialLanes
from stable_baselines3 import PPO

import visitlab_cli
from visitlab_cli.gym.humans import shipped_humans
from visitlab_cli.results.estimates import mean_of
from visitlab_cli.storage.facts import cpu_seconds_of

TRIAL = 20
"""Steps of a social trial."""
LANES = 256
OURS = {"mb": {"kind": "model_based"}, "rmax": {"kind": "rmax"}, "mf": {"kind": "q_learning"}}
SETTINGS = {
    "gamma": 0.9,  # as ours
    "n_steps": TRIAL,  # learns after each trial of all lanes
    "batch_size": 1280,
    "n_epochs": 4,
    "learning_rate": 0.003,
    "ent_coef": 0.03,  # explores: a random robot is rewarded less than once in 2,000 trials
    "normalize_advantage": False,  # rewards are that rare at first: what is no more than noise stays small
    "policy_kwargs": {"net_arch": [64]},
}


class Learned(NamedTuple):
    """What one agent reached with one human and one seed: the reward of each trial in training, seconds of one core."""

    human: str
    agent: str
    rewards: np.ndarray
    seconds: float


def ppo(human: str, steps: int, seed: int, *, whole: bool = False) -> Learned:
    """Train PPO, which sees the state in its four parts, or whole.

    The rewards are those of its first `steps` steps, as it acts in training, exploration included.
    """
    lanes = SocialLanes(human, LANES, seed, whole=whole)
    begun = time.process_time()
    PPO("MlpPolicy", lanes, seed=seed, device="cpu", **SETTINGS).learn(steps)
    seconds = time.process_time() - begun
    return Learned(
        human, "PPO, whole state" if whole else "PPO", np.concatenate(lanes.trials)[: steps // TRIAL], seconds
    )


def ours(humans: Sequence[str], steps: int, seeds: int, out: str) -> Iterator[Learned]:
    """Train visitlab's agents, an ordinary run that is kept in `out`: what is done already is not done again."""
    social = {"task": "social", "agents": list(OURS), "humans": list(humans), "steps": steps}
    run = visitlab_cli.run(
        {
            "name": "beside-ppo",
            "seeds": seeds,
            "humans": shipped_humans(),
            "agents": OURS,
            "experiments": {"social": social},
            "record": {"steps": "none"},
        },
        out,
    )
    for cell in run.cells:
        kind = OURS[cell.agent]["kind"]
        yield Learned(cell.human, kind, cell.trials["reward"], cpu_seconds_of(cell.folder) or np.nan)


def table(learned: Sequence[Learned]) -> str:
    """A line for each agent and human: means over seeds, with half their 95% intervals (Student's t)."""
    rows = [("human", "agent", "last tenth", "all trials", "core s", "seeds")]
    for human, agent in dict.fromkeys((each.human, each.agent) for each in learned):
        seeds = [each for each in learned if (each.human, each.agent) == (human, agent)]
        last = mean_of([float(each.rewards[-(len(each.rewards) // 10) :].mean()) for each in seeds])
        every = mean_of([float(each.rewards.mean()) for each in seeds])
        seconds = f"{np.mean([each.seconds for each in seeds]):.1f}"
        rows.append((human, agent, last.in_words(), every.in_words(), seconds, str(len(seeds))))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--humans", nargs="+", default=["human_1", "human_2"], metavar="HUMAN")
    parser.add_argument("--steps", type=int, default=2_000_000, help="steps of training")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--whole", action="store_true", help="PPO sees the state as one number, not in its four parts")
    parser.add_argument("--out", default="runs", help="folder of visitlab's run")
    asked = parser.parse_args(arguments)
    torch.set_num_threads(1)  # the networks are small: more cores gain nothing
    learned = list(ours(asked.humans, asked.steps, asked.seeds, asked.out))
    for human in asked.humans:
        learned += [ppo(human, asked.steps, seed, whole=asked.whole) for seed in range(asked.seeds)]
    learned.sort(key=lambda each: asked.humans.index(each.human))
    print(table(learned))


if __name__ == "__main__":
    main()
