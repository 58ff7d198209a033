"""Steps a second of the simulation on one core: tasks and agents, planning and recording on and off, controllers.

    python -m benchmarks.simulation [PART OF A NAME ...]

Each line is measured in a process of its own, by CPU time, after its kernels were compiled: the fastest of three turns,
for what else runs on a machine only ever adds. The uncompiled figure is of the same code with NUMBA_DISABLE_JIT=1, over
fewer steps, planning as often; its visits start from modules that were trained for 2,000 steps.
"""

import sys
from collections.abc import Iterator, Sequence
from typing import Any

from benchmarks.cases import Case, in_new_process, speed
from benchmarks.rows import Row, number, show

UNIT = "steps/s of CPU"
Q, MODEL_BASED, RMAX = {"kind": "q_learning"}, {"kind": "model_based"}, {"kind": "rmax"}
SELDOM = {"plan_every": 1_000_000_000}
NEVER = {"kind": "model_based", **SELDOM}
ANYWHERE, WITH_HUMANS = ("windowed", "forgetting", "coordinated"), ("multi_model",)
WALLS = {"walls": {"rooms": "3 x 3", "size": "8 x 8", "walls": "between", "doorway": 2}}
NAVIGATION, SOCIAL = Case("navigation", Q, 4_000_000), Case("social", MODEL_BASED, 1_000_000)
VISIT = Case("visit", MODEL_BASED, 200_000)
PLANNING = {
    "navigation": Case("navigation", MODEL_BASED, 1_000_000),
    "go_to_human": Case("go_to_human", MODEL_BASED, 2_000_000),
    "social": SOCIAL,
    "visit": VISIT,
}
COMPILED = {  # name: (case, steps uncompiled, steps a second to reach)
    "navigation q_learning": (NAVIGATION, 20_000, 7_000_000),
    "navigation model_based, a sweep every 1,000": (PLANNING["navigation"], 3_000, None),
    "navigation rmax": (Case("navigation", RMAX, 1_000_000), 3_000, None),
    "go_to_human model_based, a sweep every 1,000": (PLANNING["go_to_human"], 5_000, None),
    "social q_learning": (Case("social", Q, 2_000_000), 10_000, None),
    "social model_based, a sweep every 1,000": (SOCIAL, 3_000, 1_200_000),
    "social rmax": (Case("social", RMAX, 1_000_000), 3_000, None),
    "visit model_based, a sweep every 100": (VISIT, 500, 250_000),
}
BESIDE = {  # name: (case, the name of what it is compared with, its case)
    "social model_based, no sweeps": (Case("social", NEVER, 1_000_000), "a sweep every 1,000", SOCIAL),
    "visit model_based, no sweeps": (VISIT._replace(more=SELDOM, steps=1_000_000), "a sweep every 100", VISIT),
    "visit, controller route and mask": (VISIT._replace(more={"controller": ["route", "mask"]}), "paper", VISIT),
    "visit, controller lead": (VISIT._replace(more={"controller": "lead"}), "paper", VISIT),
    "navigation q_learning behind walls": (NAVIGATION._replace(more={"lab": "walls"}, labs=WALLS), "open", NAVIGATION),
    **{
        f"{task} {kind}": (case._replace(agent={"kind": kind}), "model_based", case)
        for task, case in PLANNING.items()
        for kind in ANYWHERE + (WITH_HUMANS if case in (SOCIAL, VISIT) else ())
    },
    **{
        f"social {kind}": (SOCIAL._replace(agent={"kind": kind}), "model_based", SOCIAL)
        for kind in ("dyna", "prioritized_sweeping")
    },
}
LEAST = {f"{task} {kind}": "0.83 of it" for task in PLANNING for kind in ANYWHERE}
RECORDED = {
    "navigation q_learning": NAVIGATION._replace(steps=1_000_000),
    "social model_based": SOCIAL,
    "visit model_based": VISIT,
}


def rows(parts: Sequence[str] = ()) -> Iterator[Row]:
    """Compiled beside uncompiled, cases side by side, recording beside none; those with all `parts` in their names."""

    def asked(cases: dict[str, Any]) -> dict[str, Any]:
        return {name: case for name, case in cases.items() if all(part in name for part in parts)}

    for name, (case, few, wanted) in asked(COMPILED).items():
        fast, slow = speed(case), speed(case.uncompiled(few), NUMBA_DISABLE_JIT="1")
        wanted_text = f"{wanted:,}" if wanted else ""
        yield Row(name, fast, UNIT, f"uncompiled {number(slow)}", fast / slow, wanted_text)
    for name, (case, other_name, other) in asked(BESIDE).items():
        one, beside = speed(case), speed(other)
        yield Row(name, one, UNIT, f"{other_name} {number(beside)}", one / beside, LEAST.get(name, ""))
    for name, case in asked(RECORDED).items():
        played, kept = in_new_process(case), in_new_process(case._replace(recorded=True))
        beside = f"not recorded {number(played['steps'] / played['seconds'])}"
        ratio = played["seconds"] / kept["seconds"]
        yield Row(f"{name}, recorded", kept["steps"] / kept["seconds"], UNIT, beside, ratio)
        yield Row(
            f"{name}, recorded, by the clock", kept["wall"] / played["wall"], "times", "not recorded", None, "1.1"
        )
        yield Row(f"{name}, log", kept["bytes"] / kept["steps"], "bytes a step")


if __name__ == "__main__":
    show(rows(sys.argv[1:]))
