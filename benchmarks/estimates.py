"""What a step of each kind of agent costs in each task, recorded, beside what a plan takes it to cost.

    python -m benchmarks.estimates [PART OF A NAME ...]

Plans are told from `microseconds_a_step` of the kinds: where a ratio is far from 1, that should be mended.
"""

import sys
from collections.abc import Iterator, Sequence

from benchmarks.cases import Case, in_new_process
from benchmarks.rows import Row, number, show

STEPS = {"navigation": 400_000, "go_to_human": 400_000, "social": 400_000, "visit": 100_000}


def rows(parts: Sequence[str] = ()) -> Iterator[Row]:
    """A kind in a task each; those with all `parts` in their names. What refers to other agents is left out."""
    from visitlab_cli.agents.registry import KINDS

    for word, kind in KINDS.items():
        for task, told in kind.microseconds_a_step.items():
            name = f"{word} in {task}"
            if word == "observer" or not all(part in name for part in parts):
                continue
            found = in_new_process(Case(task, {"kind": word}, STEPS[task], recorded=True))
            microseconds = 1e6 * found["seconds"] / found["steps"]
            yield Row(name, microseconds, "microseconds", f"told {number(told)}", microseconds / told)


if __name__ == "__main__":
    show(rows(sys.argv[1:]))
