"""What a kind from outside costs: a compiled plug-in beside the built-in that it copies, and an agent in plain Python.

    python -m benchmarks.plugins

Each is trained in the social task by the real command with one worker, after a first run that compiles; the kinds take
turns. The compiled ones are not recorded, and compared by the time that they play (`steps_per_second` of
timing.json); the plain one is recorded, and its figure is of the whole cell.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import visitlab_cli
from benchmarks.rows import Row, number, show
from visitlab_cli.agents import q_learning

ROUNDS = 7
STEPS = {"q_learning": 8_000_000, "q_copy": 8_000_000, "q_plain": 400_000}
WARM_UP = 2_000
PLAIN = '''
from typing import Literal

import numpy as np
from pydantic import Field

from visitlab_cli import AgentParameters


class Parameters(AgentParameters):
    """Q-learning."""

    kind: Literal["q_plain"]
    alpha: float = Field(default=0.5, gt=0, le=1, description="learning rate")
    gamma: float = Field(default=0.9, ge=0, lt=1, description="discount factor")
    epsilon: float = Field(default=0.05, ge=0, le=1, description="probability of a random action")

    def agent(self, setting):
        return Agent(self, setting)


class Agent:
    def __init__(self, parameters, setting):
        self.parameters, self.q = parameters, np.zeros((setting.n_states, setting.n_actions))

    def act(self, state, random, step):
        if random.random() < self.parameters.epsilon:
            return int(random.integers(self.q.shape[1])), True
        return self.greedy(state)

    def greedy(self, state):
        return int(self.q[state].argmax())

    def learn(self, state, action, reward, next_state, end, random, step):
        target = reward + self.parameters.gamma * self.q[next_state].max()
        self.q[state, action] += self.parameters.alpha * (target - self.q[state, action])

    def arrays(self):
        return {"q": self.q}

    def restore(self, arrays):
        self.q = arrays["q"]
'''
CONFIG = """
name: plugins
seed: {seed}
humans: {{human_2: {{p_S: [0, 0.5, 0.5], p_A: 0.05}}}}
agents: {{mine: {{kind: {kind}}}}}
experiments: {{social: {{task: social, agents: [mine], humans: [human_2], steps: {steps}}}}}
record: {{steps: {record}}}
"""


def steps_a_second(folder, kind, steps, seed):
    """Of one training."""
    config = folder / "config.yaml"
    recorded = kind == "q_plain"
    record = "every" if recorded else "none"
    config.write_text(CONFIG.format(kind=kind, steps=steps, seed=seed, record=record))
    plugins = os.pathsep.join(str(folder / f"{name}.py") for name in ("q_copy", "q_plain"))
    subprocess.run(
        [sys.executable, "-m", "visitlab_cli", "run", config, "--out", folder / "runs", "--workers", "1"],
        env=os.environ | {"VISITLAB_PLUGINS": plugins, "PYTHONPATH": str(Path(visitlab_cli.__file__).parents[1])},
        check=True,
        capture_output=True,
    )
    newest = max((folder / "runs").glob("*/social/*/*/seed-0000/timing.json"), key=lambda file: file.stat().st_mtime_ns)
    timing = json.loads(newest.read_text())
    return steps / timing["seconds"] if recorded else timing["steps_per_second"]


def rows():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        copy = Path(q_learning.__file__).read_text().replace('Literal["q_learning"]', 'Literal["q_copy"]')
        (folder / "q_copy.py").write_text(copy)
        (folder / "q_plain.py").write_text(PLAIN)
        for kind in STEPS:
            steps_a_second(folder, kind, WARM_UP, 0)
        rounds = [
            {kind: steps_a_second(folder, kind, STEPS[kind], seed) for kind in sorted(STEPS, reverse=seed % 2 == 0)}
            for seed in range(1, ROUNDS + 1)
        ]
    built_in, copied, plain = (statistics.median(each[kind] for each in rounds) for kind in STEPS)
    ratio = statistics.median(each["q_copy"] / each["q_learning"] for each in rounds)
    yield Row("social, a compiled plug-in", copied, "steps/s", f"the built-in kind {number(built_in)}", ratio)
    yield Row("social, an agent in plain Python, recorded", plain, "steps/s")


if __name__ == "__main__":
    show(rows())
