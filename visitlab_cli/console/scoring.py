"""What `score` does: play what the rows ask of each agent, then print, draw and write what they reached."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import tell, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.execution.progress import Progress
    from visitlab_cli.scores.asking import Asked
    from visitlab_cli.scores.contenders import Contender
    from visitlab_cli.scores.judging import Played, Scorecard
    from visitlab_cli.scores.rows import Rows


class Files(NamedTuple):
    """What is written beside the run folders; None is not."""

    picture: Path | None
    report: Path | None
    page: Path | None

    def check(self) -> None:
        """Refuse what can't be written there.

        Raises:
            UsageError: the picture has no format, or something there is not visitlab's.
        """
        from visitlab_cli.errors import UsageError
        from visitlab_cli.origin import check_ours
        from visitlab_cli.pictures.style import FORMATS

        if self.picture is not None and self.picture.suffix[1:] not in FORMATS:
            formats = ", ".join(f".{kind}" for kind in FORMATS)
            raise UsageError(f"--picture {self.picture}: must end in {formats}")
        for file in filter(None, self):
            check_ours(file)

    def write(self, card: "Scorecard", rows: "Rows") -> None:
        """Write all of them.

        Raises:
            UsageError: something there is not visitlab's.
            RunError: one can't be written.
        """
        from visitlab_cli.scores.html_page import save_report
        from visitlab_cli.scores.markdown_page import save_page
        from visitlab_cli.scores.picture import save_scores

        if self.picture is not None:
            save_scores(card, self.picture)
        if self.report is not None:
            save_report(card, self.report)
        if self.page is not None:
            save_page(card, rows, self.page, self.picture)


def tell_rows(rows: "Rows", *, as_json: bool) -> None:
    """Print the questions."""
    if as_json:
        told = {name: row.model_dump(mode="json") for name, row in rows.rows.items()}
        tell_json({"set": rows.number, "rows": rows.label, "questions": told})
        return
    lines = [["row", "question"], *([name, row.question] for name, row in rows.rows.items())]
    tell_text(f"{aligned(lines, words=2)}\n\nrows of {rows.label}")


def play(rows: "Rows", names: Sequence[str], asked: "Asked", out: Path, workers: int, progress: "Progress") -> "Played":
    """Run what is missing of an agent's cells for some rows, in its run folder below `out`; failures are kept.

    Raises:
        RunError: the folder can't be written.
        Interrupted: what was finished is kept.
    """
    from visitlab_cli.console.running import held_run, run_cells_of
    from visitlab_cli.scores.judging import Played

    cells = asked.needed(rows, names)
    if asked.config is None or not cells:
        return Played(asked, None, {})
    with held_run(out, asked.config, progress.warn) as (run, _):
        return Played(asked, run, run_cells_of(run, cells, workers, progress))


def score(
    rows: "Rows",
    names: Sequence[str],
    found: "Sequence[Contender]",
    seeds: int,
    out: Path,
    workers: int,
    progress: "Progress",
) -> "tuple[Scorecard, dict[str, str]]":
    """The cards of some agents for some rows, everything missing being played; and what failed, by run and cell.

    Raises:
        RunError: a folder can't be written, or a finished cell is damaged.
        UsageError: the rows ask for an optimum that nobody knows.
        Interrupted: what was finished is kept.
    """
    from visitlab_cli.scores.anchors import check_best
    from visitlab_cli.scores.asking import ask
    from visitlab_cli.scores.contenders import floor
    from visitlab_cli.scores.judging import Scorecard, judge

    random = ask(rows, floor(), seeds)
    check_best(rows, names, random)
    lowest = play(rows, names, random, out, workers, progress)
    played = [play(rows, names, ask(rows, each, seeds), out, workers, progress) for each in found]
    failures = {f"{each.run}/{path}": why for each in (lowest, *played) for path, why in each.failures.items()}
    cards = [judge(rows, names, each, lowest) for each in played]
    return Scorecard(rows.number, rows.label, seeds, cards), failures


def tell_scores(card: "Scorecard", files: Files, *, as_json: bool) -> None:
    """Print the scores, and where their runs and files are."""
    from visitlab_cli.scores.words import one_card, reasons, several_cards

    written = {name: str(file) for name, file in files._asdict().items() if file is not None}
    if as_json:
        tell_json({**card.as_json(), **written})
        return
    alone = len(card.cards) == 1
    table = one_card(card.cards[0]) if alone else several_cards(card)
    tell_text(aligned(table, words=1))
    seeds = f"{card.seeds} seed{'' if card.seeds == 1 else 's'}"
    tell("", f"rows of {card.rows}, {seeds}: 0 is random, 1 the exact optimum, or in the visit the best that is known")
    tell(*([] if alone else reasons(card.cards)))
    tell(*(str(each.run) for each in card.cards if each.run is not None), *written.values())
