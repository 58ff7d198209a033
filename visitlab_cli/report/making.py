"""From a run folder to its page: what it holds is gathered, laid out, and written whole or not at all."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from visitlab_cli.config.model import Config
from visitlab_cli.errors import NotFoundError
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.report.best_trial import best_trials
from visitlab_cli.report.curves import Chart, charts_of
from visitlab_cli.report.facts import Facts
from visitlab_cli.report.page import render
from visitlab_cli.results.against_script import against_script
from visitlab_cli.results.evaluated import evaluated
from visitlab_cli.results.expected import Result, results
from visitlab_cli.results.marginal import marginals
from visitlab_cli.results.pairs import AGENT, Pair, compare_by
from visitlab_cli.results.recorded import recorded_metrics
from visitlab_cli.results.summary import summaries
from visitlab_cli.storage.cell_folder import SOURCES, read_cell
from visitlab_cli.storage.inside import check_inside
from visitlab_cli.storage.locks import being_written
from visitlab_cli.storage.made_by import sources_of
from visitlab_cli.storage.on_disk import REPORT
from visitlab_cli.storage.run_folder import read_config, read_versions, run_name
from visitlab_cli.whole_file import write_again


class Report(NamedTuple):
    """What a page shows."""

    facts: Facts
    charts: list[Chart]
    trials: list[dict[str, Any]]


def gather(run: Path) -> Report:
    """What the page of a run shows; nothing of it depends on when, where or how fast the run was made.

    Raises:
        NotFoundError: this is no run folder.
        RunError: the run is damaged.
    """
    config = read_config(run)
    cells = plan(config)
    lines = summaries(run, cells)
    groups = [line.group for line in lines]
    others = [*evaluated(run, config).values()]
    played = [line for those in others for line in summaries(run, those)]
    expected, versions = _expected(run, config, cells), _versions(run, cells)
    facts = Facts(
        name=run_name(config),
        config=config,
        cells=cells,
        summaries=lines,
        evaluated=played,
        pairs=_pairs(run, cells),
        against_script=against_script(run, groups),
        marginals=marginals(run, groups),
        metrics=[each for those in (cells, *others) for each in recorded_metrics(run, those)],
        expected=expected,
        versions=versions,
    )
    return Report(facts, charts_of(run, groups), best_trials(run, groups))


def _pairs(run: Path, cells: Sequence[Cell]) -> list[Pair]:
    try:
        return compare_by(run, cells, AGENT).pairs
    except NotFoundError:
        return []  # nothing that is done differs in the agent alone


def _expected(run: Path, config: Config, cells: Sequence[Cell]) -> dict[str, Result]:
    """What the config expects of a group and what it has, by the group's path."""
    return {each.group: each for each in results(run, config, cells) if each.expected is not None}


def _versions(run: Path, cells: Sequence[Cell]) -> dict[str, list[str]]:
    """For each name all versions that the run was begun with and its cells were made with."""
    found: dict[str, set[str]] = {}
    facts = [each for cell in cells if (each := read_cell(run / cell.path)) is not None]
    for versions in (read_versions(run), *(each.get("versions", {}) for each in facts)):
        for name, version in versions.items():
            found.setdefault(name, set()).add(str(version))
    found[SOURCES] = {sources_of(each) for each in facts}
    return {name: sorted(versions) for name, versions in found.items()}


def make_report(run: Path, target: Path | None = None) -> Path:
    """Write the page of a run to `target`, else to `RUN/report.html`; the same bytes for the same run.

    Raises:
        NotFoundError: this is no run folder.
        UsageError: it is there and not visitlab's.
        RunError: the run is damaged, or the file cannot be written.
    """
    file = target or run / REPORT
    page = render(*gather(run)).encode()
    if target is not None:
        write_again(file, page)
        return file
    with being_written(run):
        check_inside(run, file)
        write_again(file, page)
    return file
