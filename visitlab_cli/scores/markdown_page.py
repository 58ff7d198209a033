"""A scorecard as a Markdown page: the questions, the picture, every agent's scores, how they were made."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from visitlab_cli.origin import MARKDOWN
from visitlab_cli.pictures.style import write
from visitlab_cli.scores.anchors import EXACT
from visitlab_cli.scores.judging import Scorecard
from visitlab_cli.scores.rows import Rows
from visitlab_cli.scores.words import number, reasons, row_words, several_cards

MEASURES = {
    "level": "last tenth of trials",
    "all": "all trials",
    "cpu": "all steps",
    "updates": "in the end",
}


def save_page(card: Scorecard, rows: Rows, target: Path, picture: Path | None) -> None:
    """Write the page, which shows the picture if there is one.

    Raises:
        UsageError: what is there is not visitlab's.
        RunError: it cannot be written.
    """
    shown = None if picture is None else Path(os.path.relpath(picture, target.parent)).as_posix()
    write(target, ("\n\n".join(_parts(card, rows, shown)) + "\n").encode())


def _parts(card: Scorecard, rows: Rows, picture: str | None) -> Iterator[str]:
    seeds = f"{card.seeds} seed{'' if card.seeds == 1 else 's'}"
    yield f"{MARKDOWN}score`; every number is read from runs -->"
    yield "# The scorecard"
    yield (
        "`visitlab score KIND` or `visitlab score CONFIG.yaml` asks an agent questions and gives each answer a score: "
        "0 is what random actions reach on the same cells, 1 the exact optimum of whoever sees the whole state, or the "
        "best that is known where nobody knows the optimum. A score is (value - random) / (best - random), seed by "
        "seed; what is told is the mean over seeds ± half its 95% interval (Student's t). An agent that sees less than "
        "all can't reach 1. There is no total: which question matters depends on the robot."
    )
    yield f"Quote a score with its rows, **{card.rows}**: a question that changes is another set."
    yield "## The agents"
    if picture is not None:
        yield f"![Scores as bars, a panel for each agent]({picture})"
    yield f"Scores, {seeds}; of costs the values."
    yield _table(several_cards(card))
    yield from (f"- {line}" for line in ["\n- ".join(reasons(card.cards))] if line)
    yield "## The questions"
    yield _table(_questions(card, rows))
    others = dict.fromkeys(
        f"{row_words(line.row)}: {line.best_is}"
        for each in card.cards
        for line in each.lines
        if line.best_is not in (None, EXACT)
    )
    yield (
        "Random is measured, best is the exact optimum (`visitlab optimum`)"
        + "".join(f"; {each}" for each in others)
        + ". Random and best are taken as known: the intervals are those of the agent."
    )
    yield "## Of your own"
    yield (
        "```\n"
        "visitlab score                                # the questions\n"
        "visitlab score rmax --quick                   # three seeds\n"
        "visitlab score my.yaml --agent mine           # an agent with settings of its own, ten seeds\n"
        "visitlab score my_kind --plugin my_agent.py --picture mine.svg --report mine.html\n"
        "visitlab score q_learning alpha=0.1 --only human_2 --json\n"
        "```"
    )
    yield (
        "What is played lies in ordinary runs, `score-AGENT-HASH`: they are shown, replayed and reported as any run, "
        "and what is done already is kept, also after an interruption; one trial in a hundred is recorded step by "
        "step. What an agent can't play has no score, and the reason instead."
    )
    yield (
        "Rows are data: the files of `configs/scores/`. A new question is a new file there, or in a folder of your own "
        "(`--rows FOLDER`, with a copy of `00_shared.yaml`); the first lines of that file say what may stand in one."
    )
    if made := _commands(card):
        yield made


def _commands(card: Scorecard) -> str:
    runs = sorted(each.run.name for each in card.cards if each.run is not None)
    return f"This page was made from the runs {', '.join(runs)}." if runs else ""


def _questions(card: Scorecard, rows: Rows) -> list[list[str]]:
    table = [["row", "question", "measured", "random", "best"]]
    for place, line in enumerate(card.cards[0].lines):
        known = next((each.lines[place] for each in card.cards if each.lines[place].score), line)
        star = "" if known.best_is in (None, EXACT) else "*"
        measured = f"{line.unit}, {MEASURES[rows.rows[line.row].measure]}"
        best = number(known.best) + star
        table.append([row_words(line.row), line.question, measured, number(known.random), best])
    return table


def _table(rows: Sequence[Sequence[str]]) -> str:
    """Rows under the first as Markdown."""
    lines = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:]])
