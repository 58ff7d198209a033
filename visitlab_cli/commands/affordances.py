"""`visitlab affordances`: what the social module believes, beside what is true."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, At, Json, Out, Run
from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import tell, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.affordances.learned import Affordances, Graph
    from visitlab_cli.affordances.plain import Weight
    from visitlab_cli.affordances.restricted import PairSet, Restricted
    from visitlab_cli.affordances.several import Belief, Several
    from visitlab_cli.plan.cells import Cell
    from visitlab_cli.plan.selection import Selection


HELP = Help(
    "Look",
    place=5,
    examples=(
        "visitlab affordances quickstart --intents --threshold 0.5 --trials 200",
        "visitlab affordances friends --models --experiment multi",
    ),
)


def command(
    run: Run,
    experiment: Annotated[
        str,
        typer.Option(
            "--experiment",
            "-e",
            help="Of this training, or that this visit begins with; else the visits'.",
            autocompletion=completion.experiments,
        ),
    ] = "",
    agent: Annotated[str, typer.Option(help="Of this agent.", autocompletion=completion.agents)] = "",
    human: Annotated[
        str,
        typer.Option(
            help="Trained with this human; with --experiment of a visit, visited.", autocompletion=completion.humans
        ),
    ] = "",
    seed: Annotated[
        int | None, typer.Option(min=0, help="Of this repetition, from 0; else the first, with --intents all.")
    ] = None,
    at: At = None,
    intents: Annotated[
        bool,
        typer.Option(
            "--intents",
            help="What is left of the reward with each human if it plans only with pairs of state and action that "
            "afford an intent: the human faces the robot, the distance becomes appropriate, the interaction advances, "
            "the human is led, keeps following.",
        ),
    ] = False,
    models: Annotated[
        bool,
        typer.Option(
            "--models",
            help="Of a visit whose agent has several models (multi_model): what each believes, what is general, what "
            "is specific, and whose each model is. --experiment is then the visit.",
        ),
    ] = False,
    threshold: Annotated[
        list[float] | None,
        typer.Option(
            "--threshold",
            metavar="K",
            help="With --intents: as likely an intent must be; may be repeated. Else 0.05 to 0.9.",
        ),
    ] = None,
    trials: Annotated[
        int | None,
        typer.Option(min=1, max=10**6, help="With --intents: trials that each plan is played; else 2000."),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw it, with how it adapts: a .svg, .png or .pdf."),
    ] = None,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """The learned Fig. 4: what the social module thinks that its actions do, beside what they do.

    --json has every action and level, and where it would go around the human.
    """
    from dataclasses import replace

    from visitlab_cli.affordances.learned import affordances
    from visitlab_cli.affordances.plain import as_json as to_json
    from visitlab_cli.origin import check_ours
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.plan.selection import Selection
    from visitlab_cli.storage.run_folder import find_run, read_config

    if picture is not None:
        check_ours(picture)
    _check_options(threshold or [], trials, intents=intents, models=models)
    folder = find_run(run, out)
    selection = Selection(experiment, human, agent, seed, tuple(at or ()))
    if intents:
        _tell_intents(folder, selection, threshold, trials, picture, as_json=as_json)
        return
    if models:
        _tell_models(folder, replace(selection, seed=seed or 0), picture, as_json=as_json)
        return
    cells = plan(read_config(folder))
    found = affordances(folder, cells, replace(selection, seed=seed or 0))
    if picture is not None:
        from visitlab_cli.affordances.picture import save_affordances

        save_affordances(found, picture)
        tell_json({"run": str(folder), "file": str(picture)}, None) if as_json else tell(str(picture))
    elif as_json:
        tell_json({"run": str(folder), **to_json(found)})
    else:
        tell_text("\n".join([*_lines(found), *_see_also(found, cells)]))


def _check_options(thresholds: Sequence[float], trials: int | None, *, intents: bool, models: bool) -> None:
    from visitlab_cli.errors import UsageError

    if intents and models:
        raise UsageError("--models: not together with --intents")
    for name, given in (("--threshold", bool(thresholds)), ("--trials", trials is not None)):
        if given and not intents:
            raise UsageError(f"{name}: goes with --intents only")
    for each in thresholds:
        if not 0 < each <= 1:
            raise UsageError(f"--threshold {each:g}: must be a probability above 0")


def _tell_models(folder: Path, selection: "Selection", picture: Path | None, *, as_json: bool) -> None:
    from visitlab_cli.affordances.several import as_json as to_json
    from visitlab_cli.affordances.several import several_models
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.storage.run_folder import read_config

    found = several_models(folder, plan(read_config(folder)), selection)
    if picture is not None:
        from visitlab_cli.affordances.several_picture import save_several

        save_several(found, picture)
        tell_json({"run": str(folder), "file": str(picture)}, None) if as_json else tell(str(picture))
    elif as_json:
        tell_json({"run": str(folder), **to_json(found)})
    else:
        tell_text(_models_text(found))


def _models_text(found: "Several") -> str:
    from visitlab_cli.affordances.plain import OUTCOMES
    from visitlab_cli.affordances.several import AFFORDS, COMPARED, ENOUGH

    whose = [["steps counted", "whose", "before", *found.cell.humans]]
    whose += [
        [f"model {each.number}", each.human or "several", f"{each.trained:,}", *(f"{n:,}" for n in each.steps.values())]
        for each in found.models
    ]
    rows = [["action", "level", "level next", "", "general", *(f"model {each.number}" for each in found.models)]]
    for arrow in COMPARED:
        beliefs = [found.shared[arrow], *(each.beliefs[arrow] for each in found.models)]
        words = [str(arrow.kind), arrow.level.name, OUTCOMES[arrow.outcome], str(found.verdicts[arrow])]
        rows.append([*words, *map(_belief, beliefs)])
    return "\n".join(
        [
            found.cell.path,
            aligned(whose, words=2),
            "",
            aligned(rows, words=4),
            "",
            "Probability of the level next that a model believes (true with the human whose it is, who was there in",
            "the largest part of the steps that it counts). NOT_ENGAGED: any of the levels 0 to 4. What depends on",
            f"engagement is told where the distance is right. Of models that tried it {ENOUGH} times: general: each",
            f"affords it, with more than {AFFORDS:g}; by degree: and two differ; specific: two differ, and not each",
            "affords it; none: none does; open: nobody can tell. As far as 99% intervals tell.",
        ]
    )


def _belief(belief: "Belief") -> str:
    if not belief.visits:
        return "-"
    return f"{belief.probability:.3f}" + ("" if math.isnan(belief.true) else f" ({belief.true:.3f})")


def _tell_intents(
    folder: Path,
    selection: "Selection",
    thresholds: Sequence[float] | None,
    trials: int | None,
    picture: Path | None,
    *,
    as_json: bool,
) -> None:
    from visitlab_cli.affordances.restricted import THRESHOLDS, TRIALS, restricted
    from visitlab_cli.affordances.restricted import as_json as to_json
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.storage.run_folder import read_config

    if picture is not None:
        from visitlab_cli.affordances.intents_picture import save_intents
        from visitlab_cli.affordances.picture import check_ending

        check_ending(picture)
    trials = trials or TRIALS
    cells = plan(read_config(folder))
    found = restricted(folder, cells, selection, sorted(set(thresholds or THRESHOLDS)), trials)
    if picture is not None:
        save_intents(found, picture)
        tell_json({"run": str(folder), "file": str(picture)}, None) if as_json else tell(str(picture))
    elif as_json:
        tell_json({"run": str(folder), **to_json(found, trials)})
    else:
        tell_text(_intents_text(found, trials))


def _intents_text(found: "Sequence[Restricted]", trials: int) -> str:
    lines = []
    for each in found:
        n = len(each.seeds)
        lines += [f"{each.group}, {n} seed{'' if n == 1 else 's'}", _intents_table(each), ""]
    lines += [
        "Pairs of state and action: how many afford each intent with probability k, how many are planned with (of a",
        "state without any, all that were tried), and how many (state, action, next state) a sweep goes through.",
        f"Reward a trial in {trials:,} trials, greedy, without learning; kept, and the difference by seed, against all",
        "pairs that were tried. Means over seeds, 95% intervals. own: by the agent's own values.",
    ]
    return "\n".join(lines)


def _intents_table(module: "Restricted") -> str:
    from visitlab_cli.affordances.intents import INTENTS
    from visitlab_cli.results.estimates import mean_of

    rows = [["pairs", *INTENTS, "planned with", "entries", "reward", "kept", "difference"]]
    rows.append(["own", *["-"] * (len(INTENTS) + 2), mean_of(list(module.own)).in_words(), "-", "-"])
    rows += [_intents_row(module, each) for each in module.sets]
    return aligned(rows, words=1)


def _intents_row(module: "Restricted", found: "PairSet") -> list[str]:
    from visitlab_cli.results.estimates import mean_of

    affording = ["-" if found.threshold is None else f"{each:,.0f}" for each in found.affording.mean(axis=0)]
    sizes = [f"{each.mean():,.0f}" for each in (found.pairs, found.entries)]
    reward, kept = mean_of(list(found.reward)).in_words(), module.kept(found)
    against = ["-", "-"] if found is module.whole else [_percent(kept), module.difference(found).in_words("+")]
    return [found.name, *affording, *sizes, reward, *against]


def _percent(share: float) -> str:
    return "-" if math.isnan(share) else f"{share:.0%}"


def _see_also(found: "Affordances", cells: "Sequence[Cell]") -> list[str]:
    """What else there is of the same module."""
    from visitlab_cli.affordances.learned import pool_of
    from visitlab_cli.world.columns import MODELS

    several = [cell.group for cell in cells if MODELS in cell.parts and cell.agent == found.cell.agent]
    pooled = [cell for cell in cells if found.cell.path in pool_of(cell)]
    lines = [f"With --models: each of its models in {several[0]}."] if several else []
    if pooled:
        more = f"of {len(pool_of(pooled[0]))} that {pooled[0].group} begins with as one"
        lines.append(f"It is one {more}: --experiment {pooled[0].experiment} shows that.")
    return lines


def _lines(found: "Affordances") -> list[str]:
    learned = f"as it begins: {', '.join(found.pool)} as one" if found.pool else f"learned with {found.learned_with}"
    lines = [f"{found.cell.path}, {learned}", _table({"learned": found.knows}), ""]
    for each in found.adaptations:
        lines += [
            f"{each.cell.path}, after its visit to {each.cell.human}",
            _table({"before": found.knows, "after": each.knows, "in the visit": each.saw}),
            "",
        ]
    lines += [
        "Probability of the level next (visits behind it). True: by the human's parameters, at the visits in the",
        "column before; - where they alone do not decide it. NOT_ENGAGED: any of the levels 0 to 4.",
    ]
    return lines


def _table(graphs: "dict[str, Graph]") -> str:
    from visitlab_cli.affordances.plain import ARROWS, OUTCOMES, weight

    rows = [["action", "level", "level next", *graphs, "true"]]
    for arrow in ARROWS:
        weights = [weight(graph, arrow) for graph in graphs.values()]
        learned = [f"{each.learned:.3f} ({each.visits:,})" if each.visits else "-" for each in weights]
        rows.append([str(arrow.kind), arrow.level.name, OUTCOMES[arrow.outcome], *learned, _true(weights[-1])])
    return aligned(rows, words=3)


def _true(weight: "Weight") -> str:
    if math.isnan(weight.low):
        return "-"
    low, high = f"{weight.low:.3f}", f"{weight.high:.3f}"
    return low if low == high else f"{low} to {high}"
