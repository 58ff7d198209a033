"""What was run, and how to run it again."""

from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.files import shipped_configs
from visitlab_cli.config.loading import load
from visitlab_cli.paper.page.evidence import SHIPPED, Evidence, Progress, progress_of
from visitlab_cli.paper.page.words import NOT_RUN, listed, table
from visitlab_cli.storage.run_folder import read_versions

MINUTE, MILLION = 60, 1_000_000


def run_table(evidence: Evidence) -> str:
    """The run and its variants: seeds, cells, steps, time."""
    rows = [_row(evidence.run.name, evidence.source.config.seeds, progress_of(evidence.run, evidence.cells))]
    for choice in evidence.choices:
        if choice.variant is None or choice.progress is None:
            rows.append([f"`{choice.name}`", *[NOT_RUN] * 4])
        else:
            seeds = choice.variant.cells[0].config.seeds
            rows.append(_row(choice.variant.run.name, seeds, choice.progress))
    return table(["run", "seeds", "cells done", "million steps", "minutes of computing"], rows)


def unfinished_line(evidence: Evidence) -> str:
    """What is not done yet; empty where all of it is."""
    main = progress_of(evidence.run, evidence.cells)
    names = [evidence.run.name] if main.done < main.cells else []
    names += [choice.name for choice in evidence.choices if choice.variant is not None and not choice.complete]
    return f"**Not finished:** {listed(names)}; what is said of it rests on the seeds that are done." if names else ""


def version_line(evidence: Evidence) -> str:
    """The versions that the run was begun with."""
    return ", ".join(f"{name} {version}" for name, version in read_versions(evidence.run).items())


def commands(evidence: Evidence, page: str) -> str:
    """What to type to make the page again; `page` is its file."""
    config = evidence.source.config
    shipped = {config_hash(load(file)): name for name, file in shipped_configs().items()}
    name = shipped.get(config_hash(config), str(evidence.run / "config.yaml"))
    variants = [choice.name for choice in evidence.choices if choice.variant is not None]
    lines = [f"visitlab run {name} seeds={config.seeds} --workers 2"]
    if variants:
        lines += [
            f"for variant in {' '.join(variants)}; do",
            f"    visitlab run {SHIPPED}$variant --workers 2",
            "done",
        ]
    lines.append(f"visitlab compare {evidence.run.name} --page {page}")
    return "\n".join(lines)


def _row(name: str, seeds: int, progress: Progress) -> list[str]:
    return [
        f"`{name}`",
        str(seeds),
        f"{progress.done} of {progress.cells}",
        f"{progress.steps / MILLION:.1f}",
        f"{progress.seconds / MINUTE:.1f}",
    ]
