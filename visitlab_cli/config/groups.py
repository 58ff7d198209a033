"""The groups of a config, that is what its cells are but for their seeds: their names, and what is expected of them."""

from collections.abc import Iterator

from visitlab_cli.config.grid import Variant, variants
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import Module
from visitlab_cli.wording import or_else
from visitlab_cli.world.columns import HUMAN
from visitlab_cli.yaml.problems import Issue

EVERY_CELL = ("seed", "record")
INTERACTION = "interaction"


def used(config: Config, place: Module) -> set[str]:
    """The parts of the config that the result of an experiment with this agent and human depends on, as dotted paths.

    Those of the trained modules that it starts from are among them.
    """
    settings = config.experiments[place.experiment]
    parts = {f"experiments.{place.experiment}", *EVERY_CELL}
    if place.agent:
        parameters = config.agents[place.agent]
        others = (getattr(parameters, reference) for reference in parameters.references)
        parts |= {f"agents.{agent}" for agent in (place.agent, *others)}
    parts |= {f"humans.{human}" for human in settings.humans_met(place.human or "")}
    if HUMAN in settings.plays.parts:
        parts.add(INTERACTION)
    parts |= {f"labs.{lab}" for lab in settings.lab_names if lab in config.labs}
    return parts.union(*(used(config, start) for start in settings.starts.values()))


def group_of(point: Variant, place: Module) -> str:
    """The group's name, and its folder: experiment, agent, human, and what of the point of the grid matters to it."""
    return "/".join(filter(None, (*place, point.labels_of(used(point.config, place)))))


def wrong_expected(config: Config) -> Iterator[Issue]:
    """The expected values that can never be checked: of no group, or of trials that it does not have.

    Raises:
        ConfigError: a point of the grid is not valid.
    """
    if not config.expected:
        return
    trials = dict(_groups(config))
    for group, expected in config.expected.items():
        path = ("expected", group)
        if group not in trials:
            hint = "; with `vary` the point belongs to the name" if config.vary else ""
            at_points = [name for name in trials if name.startswith(f"{group}/")]
            known = or_else(None, at_points) if at_points else or_else(group, list(trials))
            message = f"no such module or visit{hint}{known}"
            yield Issue(path, message, at="key")
        elif expected.trials is not None and expected.trials[1] > trials[group]:
            yield Issue((*path, "trials"), f"up to {expected.trials[1]}, but there are {trials[group]}")


def _groups(config: Config) -> Iterator[tuple[str, int]]:
    """Each group with its number of trials."""
    for point in variants(config):
        for name, settings in point.config.experiments.items():
            for agent in settings.trained or ("",):
                for human in settings.met or ("",):
                    yield group_of(point, Module(name, agent, human)), settings.n_trials
