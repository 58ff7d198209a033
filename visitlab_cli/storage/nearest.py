"""The run that a new one was probably meant to be, or comes from: the nearest of its name."""

from pathlib import Path

from visitlab_cli.config.canonical import hashed
from visitlab_cli.config.model import Config
from visitlab_cli.errors import VisitlabError
from visitlab_cli.storage.differences import Difference, differences, in_words
from visitlab_cli.storage.run_folder import CONFIG, all_runs, read_config, run_name


def nearest_run(out: Path, config: Config) -> tuple[Path, list[Difference]] | None:
    """The run below `out` of the config's name but another hash that differs least, and how the config differs.

    Of equals the one that changed last; a run whose config can't be read is passed over.
    """
    found = []
    for run in all_runs(out):
        if not run.name.startswith(f"{config.name}-"):
            continue
        try:
            other = read_config(run)
        except VisitlabError:
            continue
        if other.name == config.name and (differing := differences(hashed(other), hashed(config))):
            found.append((len(differing), -run.stat().st_mtime, run, differing))
    return min(found)[2:] if found else None


def news_of(out: Path, config: Config) -> str | None:
    """What to tell before `config` makes a new run folder below `out`: how it differs from the nearest of its name.

    None where the run is there already, or is the first of its name.
    """
    run = out / run_name(config)
    if (run / CONFIG).exists() or (found := nearest_run(out, config)) is None:
        return None
    nearest, differing = found
    return f"{run}: a new run: unlike {nearest}, {in_words(differing)}"
