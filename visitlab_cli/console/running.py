"""What `run`, `train` and `eval` do: run what is missing of a plan, then print the table of results."""

import os
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from visitlab_cli.console.words import aligned
from visitlab_cli.errors import Interrupted, RunError, UsageError, VisitlabError
from visitlab_cli.terminal import plain, tell, tell_all, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.config.model import Config
    from visitlab_cli.execution.dask_address import At
    from visitlab_cli.execution.executor import OpenPool
    from visitlab_cli.execution.progress import Progress
    from visitlab_cli.execution.runner import Failures
    from visitlab_cli.plan.cells import Cell
    from visitlab_cli.results.expected import Result


WHICH = "module or visit"
NO_DASK = '--executor dask needs Dask: pip install "visitlab[cluster]"'


class How(NamedTuple):
    """The options that `run`, `train` and `eval` share.

    `workers` 0: as many as there are cores; `shard` '': all; `at` None: processes of this machine.
    """

    workers: int
    dry_run: bool
    as_json: bool
    quiet: bool
    verbose: bool
    shard: str = ""
    at: "At | None" = None


def dask_at(executor: str, address: str, scheduler_file: Path | None, workers: int) -> "At | None":
    """Where the Dask cluster is that was asked for; None for processes of this machine.

    Raises:
        UsageError: these options mean nothing together, or there is no Dask.
    """
    given = [*(["--address"] if address else []), *(["--scheduler-file"] if scheduler_file else [])]
    if executor == "local":
        if given:
            raise UsageError(f"{given[0]}: add --executor dask")
        return None
    if len(given) > 1:
        raise UsageError("--address and --scheduler-file: choose one")
    if given and workers:
        raise UsageError(f"--workers: the cluster of {given[0]} has workers of its own; leave it out")
    from visitlab_cli.execution.dask_address import At

    at = At(address, scheduler_file)
    at.resolved()
    try:
        import distributed  # noqa: F401
    except ImportError as error:
        raise UsageError(NO_DASK) from error
    return at


def run_config(out: Path, config: "Config", cells_of: "Callable[[Config], list[Cell]]", how: How) -> None:
    """Run the cells of a config, in its folder below `out`, which is made; with `dry_run` only tell.

    Raises:
        RunError: as `run_and_tell`, or the folder can't be written.
    """
    from visitlab_cli.plan.notes import notes_on
    from visitlab_cli.storage.nearest import news_of
    from visitlab_cli.storage.run_folder import run_name

    if not how.quiet:
        tell_all([news_of(out, config), *notes_on(cells_of(config))])
    if how.dry_run:
        folder = out / run_name(config)
        run_and_tell(folder, config, cells_of(config), how)
        return
    with held_run(out, config, lambda line: tell(line, err=True)) as (folder, config):
        cells = cells_of(config)
        failures = run_missing(folder, cells, how)
    _tell_results(folder, config, cells, failures, how)


@contextmanager
def held_run(out: Path, config: "Config", say: "Callable[[str], None]") -> "Iterator[tuple[Path, Config]]":
    """The folder of a config's run below `out`, made or mended and held while it is written, and what it stands for.

    One that was made here goes again where the block fails before anything is in it.

    Raises:
        RunError: it can't be written, or is being removed.
    """
    from visitlab_cli.execution.versions import versions
    from visitlab_cli.storage.locks import being_written
    from visitlab_cli.storage.removal import remove_unbegun
    from visitlab_cli.storage.run_folder import mend_config, open_run, run_folder, run_name

    is_new = not (out / run_name(config)).exists()
    try:
        with being_written(run_folder(out, config), say):
            if mended := mend_config(out, config):
                say(mended)
            yield open_run(out, config, versions(config.kinds))
    except VisitlabError as error:
        if is_new and not isinstance(error, Interrupted):
            remove_unbegun(out / run_name(config))
        raise


def run_and_tell(run: Path, config: "Config", cells: "Sequence[Cell]", how: How) -> None:
    """Run the missing cells and print the results; with `dry_run` only tell what there is to do.

    A shard tells what is there by now, and expects nothing of groups that are not finished.

    Raises:
        RunError: a cell failed, or a value is not what the config expects.
        UsageError: quiet and verbose at once.
    """
    _tell_results(run, config, cells, run_missing(run, cells, how), how)


def _tell_results(run: Path, config: "Config", cells: "Sequence[Cell]", failures: "Failures | None", how: How) -> None:
    if failures is None:
        return
    from visitlab_cli.results.expected import results

    lines = results(run, config, cells)
    if how.shard:
        lines = [line.if_finished() for line in lines if line.done]
    if how.as_json:
        tell_json({"run": str(run), "results": [line.as_json() for line in lines]})
    else:
        tell_text(table(lines))
        tell("", str(run))
    raise_first(failures)
    missed = [line.group for line in lines if line.missed]
    if missed:
        raise RunError(f"not within the tolerance of what the config expects: {', '.join(missed)}")


def run_missing(run: Path, cells: "Sequence[Cell]", how: How) -> "Failures | None":
    """Run the missing cells, saying what they will cost and have cost; with `dry_run` only tell, and be None.

    Raises:
        UsageError: quiet and verbose at once.
    """
    workers = how.workers or cores()
    if how.quiet and how.verbose:
        raise UsageError("--quiet and --verbose: choose one")
    if how.shard:
        from visitlab_cli.plan.shards import Shard

        cells = Shard.from_words(how.shard).of(cells)
    if how.dry_run:
        from visitlab_cli.console.dry_run import tell_plan

        tell_plan(run, cells, workers=workers, as_json=how.as_json)
        return None
    from visitlab_cli.execution.progress import Progress
    from visitlab_cli.storage.locks import being_written

    with being_written(run):
        return run_cells_of(run, cells, workers, Progress(how.quiet, how.verbose), how.at)


def run_cells_of(
    run: Path, cells: "Sequence[Cell]", workers: int, progress: "Progress", at: "At | None" = None
) -> "Failures":
    """Run the missing ones of some cells of a run, which is held; `progress` is told what a user should know.

    Raises:
        RunError: nothing can be written, or the workers of a Dask cluster can't be used.
        NotFoundError: there is no such scheduler file.
    """
    from visitlab_cli.compiled import JIT_DISABLED
    from visitlab_cli.console.dry_run import duration
    from visitlab_cli.console.words import size_in_words
    from visitlab_cli.execution.runner import missing_cells, run_cells
    from visitlab_cli.execution.warm_up import one_for_each, warm_up
    from visitlab_cli.execution.workers import warm_up_apart
    from visitlab_cli.plan.estimate import estimate
    from visitlab_cli.sources import is_kind_of_others, sources
    from visitlab_cli.storage.inside import check_all_inside
    from visitlab_cli.storage.made_by import continued, made_by
    from visitlab_cli.storage.on_disk import bytes_below
    from visitlab_cli.storage.run_folder import edited

    check_all_inside(run, [path for cell in cells for path in (cell.path, *cell.modules.values())])
    if cells and (note := edited(run, cells[0].run_hash)):
        progress.say(note)
    missing = missing_cells(run, cells)
    needed = [path for cell in cells for path in (cell.path, *cell.modules.values())]
    ours = sources(kind for cell in cells for kind in cell.config.kinds)
    some_absent = any(cell.absent for cell in cells)  # then nobody knows what their code would be
    if not some_absent and (told := continued(made_by(run, needed), ours, bool(missing))):
        progress.warn(f"{run}: {told}")
    apart = any(is_kind_of_others(kind) for cell in missing for kind in cell.config.kinds)
    with _opened(at, workers, apart, run, missing, progress.warn) as (workers, open_pool):
        if missing:
            cost = estimate(missing, workers)
            there = f"about {duration(cost.seconds)} and {size_in_words(cost.bytes)} on the disk"
            progress.say(f"{run}: {len(missing)} of {len(cells)} cells to do, {there}")
            if cost.bytes > (free := shutil.disk_usage(run).free):
                progress.say(f"the disk has only {size_in_words(free)} left; record.steps=none writes no logs")
            present = one_for_each([cell for cell in missing if not cell.absent])
            if not apart:
                warm_up(present, progress.say)
            elif workers > 1 and not JIT_DISABLED:  # one alone compiles what it needs
                warm_up_apart(present, progress.say)
        failures = run_cells(run, cells, workers, progress, open_pool)
    if missing:
        progress.say(f"{run}: {size_in_words(bytes_below(run))} on the disk")
    return failures


@contextmanager
def _opened(
    at: "At | None", workers: int, apart: bool, run: Path, missing: "Sequence[Cell]", warn: Callable[[str], None]
) -> "Iterator[tuple[int, OpenPool]]":
    """How many workers there are, and what opens a pool of them: of a cluster they are looked at before."""
    from visitlab_cli.execution.workers import Workers

    if at is None or not missing:
        yield workers, partial(Workers, apart=apart)
        return
    from visitlab_cli.execution.dask_cluster import DaskPool

    kinds = {kind for cell in missing for kind in cell.config.kinds if not getattr(kind, "absent", "")}
    pool = DaskPool(at, min(workers, len(missing)), run, kinds, warn)
    try:
        yield pool.workers, lambda count: pool
    finally:
        pool.close()


def raise_first(failures: "Failures") -> None:
    """Tell of the first cell that failed, if any did.

    Raises:
        RunError: one did.
    """
    if failures:
        path, line = next(iter(failures.items()))
        more = f" (and {len(failures) - 1} more)" if len(failures) > 1 else ""
        raise RunError(f"{path}: {line}{more}")


def cores() -> int:
    """The cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def table(lines: Sequence["Result"]) -> str:
    """The results as aligned columns, what varies short; what is not known is a dash."""
    from visitlab_cli.results.varying import varying

    expecting = any(line.expected is not None for line in lines)
    head = ["measure", "cells", "value", *(["expected", "difference", "tolerance"] if expecting else [])]
    varied = varying((line.point for line in lines), taken=(WHICH, *head))
    rows = [[WHICH, *varied.heads.values(), *head]]
    for line in lines:
        row = [
            line.condition,
            *varied.values(line.point),
            line.measure,
            f"{line.done}/{line.cells}",
            _number(line.value, ""),
        ]
        if expecting:
            numbers = (line.expected, ""), (line.difference, "+"), (line.tolerance, "")
            row += [_number(value, sign) for value, sign in numbers]
        rows.append(row)
    rows = [list(map(plain, row)) for row in rows]
    missed = ["", *("  MISSED" if line.missed else "" for line in lines)]
    return "\n".join(map("".join, zip(aligned(rows, words=2 + len(varied.heads)).splitlines(), missed, strict=True)))


def _number(value: float | None, sign: str) -> str:
    return "-" if value is None else f"{value:{sign}.2f}"
