"""Whether what a config names is declared, and fits: agents, humans, modules, expected values."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from visitlab_cli.agents.base import AgentParameters
from visitlab_cli.agents.registry import KINDS
from visitlab_cli.config.controller import FARTHEST
from visitlab_cli.config.experiments import SocialTraining
from visitlab_cli.config.hidden import wrong_belief
from visitlab_cli.config.labs import LabSettings
from visitlab_cli.config.names import module
from visitlab_cli.config.phases import PHASES, wrong_phases
from visitlab_cli.config.places import lab_issues, place_issues
from visitlab_cli.config.visits import Pool, Visit
from visitlab_cli.humans.base import HumanParameters
from visitlab_cli.settings import key_of
from visitlab_cli.simulation.controller import LEAD, MASK, PLAN
from visitlab_cli.wording import or_else, printable
from visitlab_cli.world.columns import ENGAGEMENT
from visitlab_cli.world.tasks import NAVIGATION, SOCIAL, VISIT
from visitlab_cli.yaml.problems import Issue, Path


class Declared(NamedTuple):
    """What is declared, by name; None for what is declared but wrong in itself."""

    humans: Mapping[str, HumanParameters | None]
    agents: Mapping[str, AgentParameters | None]
    experiments: Mapping[str, Any]
    expected: Iterable[str] = ()
    farthest: int = 0
    """The largest of the distances of interaction, in cells, where they are right in themselves."""
    labs: Mapping[str, LabSettings | None] = {}


def issues(declared: Declared) -> list[Issue]:
    """Everything that is wrong between the parts of a config."""
    found: list[Issue] = []
    for section, entries in zip(Declared._fields, declared[:3], strict=False):
        found += _same_folder(section, entries)
    found += lab_issues(declared.labs)
    for name, agent in declared.agents.items():
        if agent is not None:
            found += _agent(("agents", name), agent, declared)
    for name, experiment in declared.experiments.items():
        path = ("experiments", name)
        if experiment is not None and experiment.trained:
            found += _players(path, experiment, declared)
        if getattr(experiment, "start_from", None) is not None:
            messages = _start(name, experiment, experiment.start_from, declared)
            found += [Issue((*path, "start_from"), message) for message in messages]
        if experiment is not None:
            players = (declared.agents.get(agent) for agent in _acting(experiment))
            found += wrong_phases(path, experiment, declared.humans, [each for each in players if each is not None])
            humans = getattr(experiment, "humans", ())
            found += _each_declared("human", (*path, "humans"), humans, declared.humans)
            if experiment.plays.has(ENGAGEMENT):
                found += wrong_belief(path, experiment, _met(experiment, declared))
            found += place_issues(path, experiment, declared.experiments, declared.labs)
        if experiment is not None and experiment.assembled:
            found += _visit(path, experiment, declared)
    for cell in declared.expected:
        found += _expected(cell, declared)
    return found


def _met(experiment: Any, declared: Declared) -> Iterator[tuple[Path, str, HumanParameters | None]]:
    """Each human that is met: the place in the experiment where its name stands, the name, and its parameters."""
    for index, human in enumerate(getattr(experiment, "humans", ())):
        yield ("humans", index), human, declared.humans.get(human)
    for index, phase in enumerate(experiment.phases):
        yield (PHASES, index, "human"), phase.met, declared.humans.get(phase.met)


def _acting(experiment: Any) -> Sequence[str]:
    """The names of the agents that act in an experiment."""
    return [experiment.starts[SOCIAL].agent] if experiment.assembled else experiment.agents


def _same_folder(section: str, entries: Iterable[str]) -> Iterator[Issue]:
    seen: dict[str, str] = {}
    for name in entries:
        first = seen.setdefault(name.lower(), name)
        if first != name:
            message = f"differs from {first} in case only, which some file systems ignore"
            yield Issue((section, name), message, at="key")


def _each_declared(what: str, path: Path, names: Sequence[str], known: Mapping[str, Any]) -> Iterator[Issue]:
    for index, name in enumerate(names):
        if name not in known:
            yield Issue((*path, index), f"no {what} is called {name}{or_else(name, list(known))}")


def _agent(path: Path, agent: AgentParameters, declared: Declared) -> Iterator[Issue]:
    for field, kinds in agent.references.items():
        name, key = getattr(agent, field), key_of(type(agent), field)
        other = declared.agents.get(name)
        if name not in declared.agents:
            others = [known for known in declared.agents if known != path[-1]]
            yield Issue((*path, key), f"no agent is called {printable(name)}{or_else(name, others)}")
        elif other is not None and kinds and _kind(other) not in kinds:
            message = f"must name an agent of kind {' or '.join(kinds)} ({name} is of kind {_kind(other)})"
            yield Issue((*path, key), message)
        elif other is not None and not kinds and other.references:
            message = f"{name} refers to other agents itself; name one that does not"
            yield Issue((*path, key), message)
        elif other is not None and (why := agent.unfit(field, other)):
            yield Issue((*path, key), f"{name} {why}")


def _kind(agent: AgentParameters) -> str:
    return str(getattr(agent, "kind", "?"))


def _players(path: Path, experiment: Any, declared: Declared) -> Iterator[Issue]:
    yield from _each_declared("agent", (*path, "agents"), experiment.agents, declared.agents)
    for index, name in enumerate(experiment.agents):
        for issue in _can_play(name, experiment.task, declared):
            yield Issue((*path, "agents", index), issue)


def _can_play(name: str, task: str, declared: Declared) -> Iterator[str]:
    agent = declared.agents.get(name)
    if agent is None:
        return
    together = [(name, agent)]
    for field in agent.references:
        other = declared.agents.get(getattr(agent, field))
        together += [(getattr(agent, field), other)] if other is not None else []
    for who, player in together:
        if task not in player.playable:
            through = "" if who == name else f", which {name} refers to,"
            yield f"{who}{through} cannot play {task}; it plays {', '.join(player.playable)}"


def _visit(path: Path, visit: Visit, declared: Declared) -> Iterator[Issue]:
    pool = visit.modules.pool
    wrong: list[str] = []
    for role, text in visit.modules.by_role.items():
        steers = role in visit.steering
        place: Path = (SOCIAL, "pool", pool.pool.index(text)) if pool and not steers else (role,)
        for message in _module(role if steers else SOCIAL, text, declared):
            wrong.append(role)
            yield Issue((*path, "modules", *place), message)
    # what follows from who plays would be told of somebody who was not meant
    navigation = None if NAVIGATION in wrong else declared.agents.get(module(visit.modules.navigation).agent)
    if set(wrong) - {*visit.steering}:
        yield from _controller(path, visit, None, navigation, declared)
        return
    name = visit.starts[SOCIAL].agent
    social = declared.agents.get(name)
    for message in _can_play(name, VISIT, declared):
        yield Issue((*path, "modules", SOCIAL), message)
    if pool and social is not None:
        yield from _pool((*path, "modules", SOCIAL, "pool"), pool, social, declared)
    for option in Visit.planning_options:
        if social is not None and not social.plans and option in visit.model_fields_set:
            message = f"means nothing here: the social module's agent, {name}, does not plan; leave it out"
            yield Issue((*path, option), message, at="key")
    yield from _controller(path, visit, social, navigation, declared)


def _pool(path: Path, pool: Pool, first: AgentParameters, declared: Declared) -> Iterator[Issue]:
    """Why what several agents have learned can't become one; the agent of the first plays."""
    if not first.pools:
        can = " or ".join(kind for kind, agent in KINDS.items() if agent.pools)
        yield Issue((*path, 0), f"an agent of kind {_kind(first)} can't be put together of several; one of {can} can")
        return
    named = module(pool.pool[0]).agent
    for index, text in enumerate(pool.pool):
        other = declared.agents.get(module(text).agent)
        if other is None:
            continue
        if _kind(other) != _kind(first):
            yield Issue((*path, index), f"is of kind {_kind(other)}, {named} of kind {_kind(first)}; a pool is of one")
        elif why := first.goes_on_from(other):
            yield Issue((*path, index), f"{named} and {module(text).agent} can't be one: {why}")


def _controller(
    path: Path, visit: Visit, social: AgentParameters | None, navigation: AgentParameters | None, declared: Declared
) -> Iterator[Issue]:
    """What a controller other than the paper's needs and has not, of agents as far as they are known."""
    options = visit.options
    if visit.told and PLAN not in options:
        yield Issue((*path, "told"), "means nothing here: the controller does not plan; leave it out", at="key")
    name = module(visit.modules.navigation).agent
    if options and navigation is not None and not navigation.plans:
        message = f"needs a navigation module that learns a model; {name}, of kind {_kind(navigation)}, has none"
        yield Issue((*path, "controller"), message)
    if NAVIGATION in visit.learns and not options:
        message = "navigation goes on learning where moves end, which only another controller than the paper's asks it"
        yield Issue((*path, "learns"), message)
    if "navigation_model" in visit.model_fields_set and NAVIGATION not in visit.learns:
        message = "means nothing here: navigation does not go on learning; leave it out"
        yield Issue((*path, "navigation_model"), message, at="key")
    if MASK in options and social is not None and not social.takes_masks:
        message = f"can't mask the social module's agent, which is of kind {_kind(social)}"
        yield Issue((*path, "controller"), message)
    if LEAD in options and declared.farthest > FARTHEST:
        message = f"leading is planned up to {FARTHEST} cells, and interaction.distances go to {declared.farthest}"
        yield Issue((*path, "controller"), message)
    for place, human, parameters in _met(visit, declared) if visit.told else ():
        if parameters is not None and not (hasattr(parameters, "p_S") and hasattr(parameters, "p_A")):
            yield Issue((*path, *place), f"told: {human} has no p_S and p_A to tell")


def _module(task: str, text: str, declared: Declared) -> Iterator[str]:
    experiment_name, agent, human = module(text)
    fitting = [name for name, other in declared.experiments.items() if getattr(other, "task", None) == task]
    if experiment_name not in declared.experiments:
        yield f"no experiment is called {experiment_name}{or_else(experiment_name, fitting)}"
        return
    experiment = declared.experiments[experiment_name]
    if experiment is None:
        return
    if experiment.task != task:
        yield f"{experiment_name} has the task {experiment.task}; needed is {task}{or_else(None, fitting)}"
    elif agent not in experiment.agents:
        yield f"{experiment_name} does not train {agent}{or_else(agent, experiment.agents)}"
    else:
        yield from _module_human(text, human, experiment)


def _start(name: str, training: SocialTraining, text: str, declared: Declared) -> Iterator[str]:
    """What is wrong with a social training's `start_from`, if anything."""
    wrong = list(_module(SOCIAL, text, declared))
    if wrong:
        yield from wrong
        return
    experiment_name, agent, human = module(text)
    other = declared.experiments[experiment_name]
    if human is None and other is not None:
        yield f"say with which human: {text}/{(*other.met, 'HUMAN')[0]}"
    circle = _circle(name, declared.experiments)
    if circle:
        yield f"goes round in a circle: {' -> '.join(circle)}"
    start = declared.agents.get(agent)
    for player in training.agents:
        own = declared.agents.get(player)
        if own is None or start is None:
            continue
        if _kind(own) != _kind(start):
            yield f"{agent} is of kind {_kind(start)}; {player}, of kind {_kind(own)}, can't go on from it"
        elif why := own.goes_on_from(start):
            yield f"{player} can't go on from {agent}: {why}"


def _circle(name: str, experiments: Mapping[str, Any]) -> list[str]:
    """The experiments from `name` back to it, each starting from the next; empty where it is in no circle."""
    chain = [name]
    while (start := getattr(experiments.get(chain[-1]), "start_from", None)) is not None:
        chain.append(module(start).experiment)
        if chain[-1] in chain[:-1]:
            return chain if chain[-1] == name else []
    return []


def _module_human(text: str, human: str | None, experiment: Any) -> Iterator[str]:
    humans = experiment.met
    if human is None and len(humans) > 1:
        yield f"say with which human: {' or '.join(f'{text}/{name}' for name in humans)}"
    elif human is not None and not experiment.plays.has(ENGAGEMENT):
        yield f"{experiment.task} has no human; write {text.rpartition('/')[0]}"
    elif human is not None and humans and human not in humans:
        yield f"{text.split('/')[0]} does not train with {human}{or_else(human, humans)}"


def _expected(cell: str, declared: Declared) -> Iterator[Issue]:
    name, *parts = cell.split("/")
    path = ("expected", cell)
    if name not in declared.experiments:
        near = or_else(name, list(declared.experiments))
        yield Issue(path, f"no experiment is called {printable(name)}{near}", at="key")
        return
    experiment = declared.experiments[name]
    if experiment is None:
        return
    levels = [names for names in (experiment.trained, experiment.met) if names]
    if len(parts) != len(levels):
        words = [("agent", experiment.trained), ("human", experiment.met)]
        form = "/".join([name, *(PHASES if names == (PHASES,) else word for word, names in words if names)])
        yield Issue(path, f"must be {form}", at="key")
        return
    for part, names in zip(parts, levels, strict=True):
        if part not in names:
            yield Issue(path, f"{name} has no {printable(part)}{or_else(part, names)}", at="key")
