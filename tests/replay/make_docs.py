"""Make the pictures of docs/replay.md and the facts in it anew: `python -m tests.replay.make_docs`.

The trial is one of quickstart as shipped, hence the same wherever this runs.
"""

import re
import tempfile
from pathlib import Path

from tests.program import the_run, visitlab
from visitlab_cli.replay.picture import save_picture
from visitlab_cli.replay.strip import save_strip
from visitlab_cli.scene.moments import SEEN, facts
from visitlab_cli.scene.trial import Trial, load_trial
from visitlab_cli.scene.words import caption
from visitlab_cli.world.lab import paper_lab

DOCS = Path(__file__).parents[2] / "docs"
PAGE, PICTURE, STRIP = DOCS / "replay.md", DOCS / "images" / "replay.png", DOCS / "images" / "strip.png"
CELL = "visit/human_2/seed-0000"
TRIAL, STEP = 31, 12
BEGIN, END = "<!-- facts: made by python -m tests.replay.make_docs -->", "<!-- end of facts -->"


def run_quickstart(out: Path) -> Path:
    """Run quickstart as shipped; whether its values are as expected is another test's matter."""
    done = visitlab("run", "quickstart", "--out", out, "--quiet")
    assert done.returncode in (0, 4), done.stderr
    return the_run(out)


def documented_trial(run: Path) -> Trial:
    return load_trial(run / CELL / "steps.mcap", TRIAL)


def fact_lines(trial: Trial) -> str:
    lines = [
        f"- **Step {step}, {'first seen' if kind == SEEN else kind}:** {caption(trial.steps, step, paper_lab())}."
        for kind, step in facts(trial.steps, paper_lab()).items()
    ]
    return "\n".join(lines)


def facts_of(page: str) -> str:
    """The facts as they stand in the page."""
    found = re.search(f"{re.escape(BEGIN)}\n(.*)\n{re.escape(END)}", page, re.DOTALL)
    assert found, f"{PAGE}: lacks {BEGIN} ... {END}"
    return found[1]


def main() -> None:
    with tempfile.TemporaryDirectory() as out:
        trial = documented_trial(run_quickstart(Path(out)))
    page = PAGE.read_text()
    PAGE.write_text(page.replace(facts_of(page), fact_lines(trial)))
    save_picture(trial, STEP, PICTURE)
    save_strip(trial, STRIP)


if __name__ == "__main__":
    main()
