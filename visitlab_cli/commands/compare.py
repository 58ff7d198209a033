"""`visitlab compare`: a run with the published curves, its conditions with each other, or with another run.

With the published curves there is a verdict on each, and the cause if one is there.
"""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import FIRST_TRIALS, RUNS, First, Json, Out, Run
from visitlab_cli.console.unread import tell_unread
from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import tell, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.paper.judging.comparison import Compared, Comparison
    from visitlab_cli.paper.judging.judge import Judgement

HELP = Help(
    "Look",
    place=4,
    examples=(
        "visitlab compare quickstart",
        "visitlab compare quickstart short",
    ),
)


MARKS = {"agrees": " ", "undecided": "?", "differs": "!"}


def command(
    run: Run,
    other: Annotated[
        str | None,
        typer.Argument(
            metavar="OTHER",
            help="A second run: what both have is compared, instead of the published curves.",
            autocompletion=completion.runs,
        ),
    ] = None,
    by: Annotated[
        str | None,
        typer.Option(
            metavar="KEY",
            help="What is compared: agent, human, experiment (visits), phase, or the path of a setting that varies.",
            autocompletion=completion.varied,
        ),
    ] = None,
    variant: Annotated[
        list[str] | None, typer.Option(help="Look for causes in this run, too; may be repeated.", metavar="RUN")
    ] = None,
    phase: Annotated[
        int | None, typer.Option(min=0, help="With --by and phases: all trials of this one, from 0, instead.")
    ] = None,
    first: First = FIRST_TRIALS,
    margin: Annotated[
        float, typer.Option(min=0, max=10**6, help="How far, in reward a trial, is still the same.")
    ] = 0.5,
    page: Annotated[
        Path | None,
        typer.Option(metavar="FILE.md", help="Write it as a page; pictures in images/reproduction beside it."),
    ] = None,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Compare a run with every published curve, with another run, or --by agent, human, experiment, phase or setting.

    With a curve: agrees, differs or undecided, and why; causes are looked for in all runs of the folder that RUN
    lies in, and in each --variant. Else: difference with 95% interval, seeds, probability of improvement.
    """
    from visitlab_cli.console.phases import PHASE
    from visitlab_cli.errors import NotFoundError, UsageError
    from visitlab_cli.paper.judging.comparison import compare
    from visitlab_cli.paper.judging.variants import open_variant, variants_beside
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.storage.made_by import made_by, mixed
    from visitlab_cli.storage.run_folder import find_run, read_config

    if phase is not None and by in (None, PHASE):
        raise UsageError("--phase: goes with --by agent, human, experiment or the path of a setting")
    folder = find_run(run, out)
    if by is not None or other is not None:
        if variant or (by is not None and other is not None):
            raise UsageError("OTHER, --by and --variant: choose one")
        if page is not None:
            raise UsageError("--page: is for the published curves; leave OTHER and --by out")
        from visitlab_cli.console.pairs import tell_by, tell_runs
        from visitlab_cli.console.phases import tell_phases

        if by == PHASE:
            tell_phases(folder, first, as_json)
        elif by is not None:
            tell_by(folder, by, phase, as_json)
        elif other is not None:
            tell_runs(folder, find_run(other, out), as_json)
        return
    asked = [open_variant(find_run(word, out)) for word in variant or []]
    known = {each.run.resolve() for each in asked}
    beside = [each for each in variants_beside(folder) if each.run.resolve() not in known]
    cells, variants = plan(read_config(folder)), [*asked, *beside]
    compared = compare(folder, cells, variants, margin)
    if not compared.curves:
        reason = next((each for _, each in compared.absent if each.is_planned), compared.absent[0][1])
        raise NotFoundError(f"{folder}: has no curve that was published ({reason.group}: {reason.reason}, and so on)")
    if page is not None:
        from visitlab_cli.figures.making import NAMES, make_figures
        from visitlab_cli.paper.page.evidence import gather
        from visitlab_cli.paper.page.text import CAPTIONS
        from visitlab_cli.paper.page.writing import write_page
        from visitlab_cli.replay.strip import strip

        def draw(of: Path, kind: str, into: Path) -> list[Path]:
            shown = [name for name in NAMES if name in CAPTIONS]
            return make_figures(of, strip, only=shown, kind=kind, into=into).files

        files = [str(file) for file in write_page(gather(folder, cells, compared, margin, variants), page, draw)]
        tell_json({"run": str(folder), "files": files}, None) if as_json else tell(*files)
    elif as_json:
        tell_json({"run": str(folder), "margin": margin, "confidence": 0.95, **_json(compared)})
    else:
        tell_text(_text(compared, margin))
    if told := mixed(made_by(folder, (cell.path for cell in cells))):
        tell(f"{folder}: {told}", err=True)
    tell_unread(folder, cells)


def _json(compared: "Compared") -> dict[str, object]:
    absent = [
        {"figure": published.figure, "condition": published.condition, "group": ours.group, "reason": ours.reason}
        for published, ours in compared.absent
    ]
    return {"curves": [each.as_json() for each in compared.curves], "not_compared": absent}


def _text(compared: "Compared", margin: float) -> str:
    from visitlab_cli.results.units import SHARED

    first = compared.curves[0]
    rows = [["figure", "condition", "verdict", "n", *map(_words, first.parts), "possible"]]
    rows += [_row(each) for each in compared.curves]
    lines = [
        aligned(rows, words=3),
        "",
        f"Ours less the published, with 95% intervals; margin {margin:g} reward a trial. ! differs, ? undecided.",
        "No number of seeds would decide where the published ten alone leave it open.",
        "Possible: the last tenth's share of what the optimum has over random actions, ours (published).",
    ]
    if any(each.one_model for each in compared.curves):
        lines.append(
            "The published fig8_adaptation rests on one trained model, whose own luck no interval here counts."
        )
    if any(each.ours.curve.counted.shared for each in compared.curves):
        lines.append(SHARED)
    lines += [line for each in compared.curves for line in _remarks(each)]
    reasons: dict[str, list[str]] = {}
    for _, ours in compared.absent:
        reasons.setdefault(ours.reason, []).append(ours.group)
    lines += [f"not compared: {reason}: {', '.join(dict.fromkeys(groups))}" for reason, groups in reasons.items()]
    return "\n".join(lines)


def _row(each: "Comparison") -> list[str]:
    last = each.parts["last_tenth"]
    shares = [each.possible.share(value) for value in (last.ours, last.published)] if each.possible else []
    possible = "{:.1%} ({:.1%})".format(*shares) if shares else "-"
    names = each.published.figure, each.published.condition, str(each.verdict), _n(each)
    return [*names, *(_difference(part) for part in each.parts.values()), possible]


def _n(each: "Comparison") -> str:
    counted = each.ours.curve.counted
    return counted.words if counted.shared else str(counted.n)


def _difference(part: "Judgement") -> str:
    half = "?" if math.isnan(part.low) else f"{part.high - part.difference:.2f}"
    return f"{part.difference:+.2f} ± {half} {MARKS[part.verdict]}"


def _remarks(each: "Comparison") -> list[str]:
    """The cause, the seeds that would decide, and what the variants gave."""
    name = f"{each.published.figure} {each.published.condition}"
    lines = [f"{name}: cause: {each.cause}"] if each.cause else []
    causes = {part: each.cause_of(part) for part, found in each.parts.items() if found.verdict == "differs"}
    lines += [f"{name}: {_words(part)}: cause: {cause}" for part, cause in causes.items() if cause != each.cause]
    open_parts = {_words(part): found for part, found in each.parts.items() if found.verdict == "undecided"}
    if each.ours.curve.counted.n < 2:
        lines.append(f"{name}: one {each.ours.curve.counted.of.removesuffix('s')} has no interval; more are needed")
    elif open_parts:
        needed = [f"{part} {found.seeds_that_decide or 'no number of'} seeds" for part, found in open_parts.items()]
        lines.append(f"{name}: would decide: {', '.join(needed)}")
    for tried in each.tried:
        parts = ", ".join(f"{_words(part)} {_difference(found).strip()}" for part, found in tried.parts.items())
        lines.append(f"{name}: with {tried.name} ({'; '.join(tried.changes)}): {tried.verdict}: {parts}")
    return lines


def _words(part: str) -> str:
    return part.replace("_", " ")
