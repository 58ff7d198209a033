"""One task of plain values, checked as a config's experiment is: what those say who play it from Python."""

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.config.experiment import Experiment
from visitlab_cli.config.loading import load_text
from visitlab_cli.errors import ConfigError, UsageError
from visitlab_cli.humans.base import HumanParameters
from visitlab_cli.wording import shown
from visitlab_cli.world.columns import ENGAGEMENT
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, TASKS, VISIT

HUMAN, LAB, AGENT, NAME, LENGTH = "human", "lab", "nobody", "task", "steps"


class OneTask(NamedTuple):
    """The settings as a config has them, the four thresholds of distance in cells, the human where there is one."""

    settings: Experiment
    distances: tuple[int, ...]
    human: HumanParameters | None


def one_task(
    task: str,
    settings: Mapping[str, Any],
    distances: Sequence[int],
    human: Mapping[str, Any] | None = None,
    others: Mapping[str, Any] | None = None,
    lab: Mapping[str, Any] | str | None = None,
) -> OneTask:
    """Check the settings of a task, those left out being the defaults.

    Args:
        task: its name.
        settings: of its experiment, but for who plays, whom it meets and how long.
        distances: the four thresholds of distance, in cells.
        human: whom the robot meets, as an entry of a config; in social and visit there must be one.
        others: humans, as entries by name, that this one may be like.
        lab: where it takes place, as an entry of a config, or a map itself; the paper's unless given. Not for social.

    Raises:
        UsageError: a setting is unknown or wrong; a line for each, without the places of a config.
    """
    experiments: dict[str, dict[str, Any]] = {
        name: {"task": name, "agents": [AGENT]} for name in (NAVIGATION, GO_TO_HUMAN, SOCIAL)
    }
    experiments[SOCIAL] |= {"humans": [HUMAN]}
    if lab is not None and not isinstance(lab, str | Mapping):
        raise UsageError(f"lab: must be a mapping, as under labs in a config, or a map (got {shown(lab)})")
    for entry in (*(others or {}).values(), *(() if human is None else (human,))):
        if not isinstance(entry, Mapping):
            raise UsageError(f"human: must be a mapping, as under humans in a config (got {shown(entry)})")
    labs: dict[str, Any] = {}
    if lab is not None:
        labs = {LAB: {"map": lab} if isinstance(lab, str) else dict(lab)}
        for name in (NAVIGATION, GO_TO_HUMAN):
            experiments[name]["lab"] = LAB
        settings = {**settings, "lab": LAB}
    if task == VISIT:
        modules = {name: f"{name}/{AGENT}" for name in experiments}
        experiments[VISIT] = {"task": VISIT, "modules": modules, "humans": [HUMAN], **settings}
    else:  # one trial, so that any number of steps will do
        length = {LENGTH: settings["trial_steps"]} if "trial_steps" in settings else {}
        experiments = {task: {**experiments[task], **settings, **length}}
    config = {
        "name": NAME,
        "agents": {AGENT: {"kind": "random"}},
        "labs": labs,
        "humans": {**(others or {}), **({} if human is None else {HUMAN: dict(human)})},
        "experiments": experiments,
        "interaction": {"distances": [*distances] if isinstance(distances, Iterable) else distances},
    }
    try:
        checked = load_text(json.dumps(config), NAME)
    except ConfigError as error:
        told = [problem for problem in error.problems if not str(problem["path"]).endswith(f".{LENGTH}")]
        raise UsageError(*dict.fromkeys(map(_in_words, told))) from None
    except (TypeError, ValueError) as error:
        raise UsageError(f"settings must be plain values, as YAML has them: {error}") from None
    met = checked.humans[HUMAN] if TASKS[task].has(ENGAGEMENT) else None
    return OneTask(checked.experiments[task], checked.interaction.distances, met)


def q_table(argument: str, module: str, given: Any, shape: tuple[int, ...]) -> npt.NDArray[np.float64]:
    """What a module has learned, of shape (states, actions), as `argument` has it.

    Raises:
        UsageError: it is no table of finite numbers of that shape.
    """
    try:
        table = np.asarray(given)
    except ValueError:
        table = np.array(None)
    is_real = table.dtype.kind in "iuf"
    if not is_real or table.shape != shape or not np.isfinite(table).all():
        got = table.dtype if not is_real else table.shape if table.shape != shape else "some that are not finite"
        raise UsageError(f"{argument}: the Q of {module} must be finite numbers of shape {shape} (got {got})")
    return np.ascontiguousarray(table, np.float64)


def _in_words(problem: Mapping[str, Any]) -> str:
    """What is wrong with which argument."""
    path = str(problem["path"] or "").split(".")
    named = {"experiments": path[2:], "humans": path[1:], "labs": path[1:], "interaction": path[1:]}.get(path[0], path)
    return f"{'.'.join(named)}: {problem['message']}"
