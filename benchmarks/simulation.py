"""Steps a second of the simulation on one core, planning included, recording not; compiled beside uncompiled.

    python -m benchmarks.simulation

Each line is measured in a process of its own. The uncompiled figure is of the same code with NUMBA_DISABLE_JIT=1,
over fewer steps, planning as often. The visit starts from the social module trained in the line before.
"""

import json
import os
import subprocess
import sys
import time

CASES = {  # name: (steps compiled, steps uncompiled, steps a second that an independent simulation reaches untuned)
    "navigation q_learning": (2_000_000, 20_000, 1_500_000),
    "navigation model_based": (500_000, 3_000, None),
    "navigation rmax": (500_000, 3_000, None),
    "go_to_human model_based": (500_000, 5_000, None),
    "social q_learning": (1_000_000, 10_000, None),
    "social model_based": (500_000, 3_000, 400_000),
    "social rmax": (500_000, 3_000, None),
    "visit model_based": (100_000, 500, 60_000),
}
HUMAN_2 = {"p_S": (0.0, 0.5, 0.5), "p_H": 0.05, "p_M": 0.05, "p_O": 0.15, "p_A": 0.05, "p_P": 0.0}
WARM_UP_STEPS = 200
SOCIAL_STEPS = 500_000


def measure(name, steps):
    """Steps a second of playing `steps` steps of a case, after a warm-up."""
    import numpy as np
    from pydantic import TypeAdapter

    from visitlab_cli.agents.base import Setting
    from visitlab_cli.agents.registry import AnyAgent
    from visitlab_cli.compiled import JIT_DISABLED
    from visitlab_cli.humans.six_parameters import SixParameters
    from visitlab_cli.random_numbers import random_state
    from visitlab_cli.simulation.loop import BLOCK_ROWS, START, play
    from visitlab_cli.simulation.visit import make_visit
    from visitlab_cli.world.columns import empty_columns
    from visitlab_cli.world.go_to_human import make_go_to_human
    from visitlab_cli.world.lab import paper_lab
    from visitlab_cli.world.navigation import make_navigation
    from visitlab_cli.world.social import make_social
    from visitlab_cli.world.tasks import TASKS
    from visitlab_cli.world.visit import make_visit_world

    def run(record, agent, task, steps):
        random, columns = random_state(0, task), empty_columns(BLOCK_ROWS)
        rewards, cursor = np.zeros(steps // record.trial_steps + 1), START
        begun = time.process_time()
        while cursor.steps < steps:
            cursor, _ = play(record, agent, cursor, steps, random, columns, rewards)
        return steps / (time.process_time() - begun)

    def trained(task, record, steps):
        parameters = TypeAdapter(AnyAgent).validate_python({"kind": "model_based"})
        agent = parameters.create(Setting(task, *TASKS[task].size(paper_lab()), steps))
        run(record, agent, task, steps)
        return parameters.save(agent)

    task, kind = name.split()
    parameters = TypeAdapter(AnyAgent).validate_python({"kind": kind})
    human = SixParameters(**HUMAN_2).create()
    if task == "visit":
        # uncompiled, training would take hours: the same sweep over a model of fewer successors
        lessons = 2000 if JIT_DISABLED else SOCIAL_STEPS
        social = trained("social", make_social(human), lessons)
        tables = [trained(each, make(), min(lessons, 200_000))["q"] for each, make in
                  (("navigation", make_navigation), ("go_to_human", make_go_to_human))]  # fmt: skip
        record = make_visit(make_visit_world(human), *tables)
        parameters = parameters.model_copy(update={"plan_every": 100})

        def agent(steps):
            return parameters.restore(Setting(task, *TASKS[task].size(paper_lab()), steps), social)
    else:
        makers = {"navigation": make_navigation, "go_to_human": make_go_to_human, "social": lambda: make_social(human)}
        record = makers[task]()

        def agent(steps):
            return parameters.create(Setting(task, *TASKS[task].size(paper_lab()), steps))

    run(record, agent(WARM_UP_STEPS), task, WARM_UP_STEPS)
    return run(record, agent(steps), task, steps)


def in_new_process(name, steps, **environment):
    command = [sys.executable, "-m", "benchmarks.simulation", name, str(steps)]
    done = subprocess.run(command, env=os.environ | environment, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def main():
    print(f"{'':24}{'compiled':>14}{'uncompiled':>14}{'ratio':>8}{'to reach':>12}   steps a second of CPU time")
    for name, (steps, few, wanted) in CASES.items():
        fast = in_new_process(name, steps)
        slow = in_new_process(name, few, NUMBA_DISABLE_JIT="1")
        print(f"{name:24}{fast:14,.0f}{slow:14,.0f}{fast / slow:8.0f}{wanted or '-':>12}", flush=True)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(json.dumps(measure(sys.argv[1], int(sys.argv[2]))))
    else:
        main()
