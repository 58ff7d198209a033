"""Trials as a Minari data set (HDF5), which offline reinforcement learning reads: https://minari.farama.org.

A trial is an episode: n actions, rewards, terminations and truncations, n + 1 observations and infos, the first of
which is how the trial begins. An observation is the task's state, a number. No trial terminates: its last step is a
truncation, by the time limit. The infos are all other columns of the log.

Minari's own library makes the data set and says what is in it. The episodes are written beside that, in its format,
since it gives each array of an episode room to grow: five times the space.
"""

import contextlib
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import NotFoundError, UsageError
from visitlab_cli.log.reader import Columns, check_values, iter_steps, read_metadata, read_trial, whole_trials
from visitlab_cli.scene.trial import config_of_log, lab_of_log, player_of
from visitlab_cli.whole_file import new_folder
from visitlab_cli.world.tasks import TASKS

NAMESPACE = "visitlab"
MISSING = 'a Minari data set needs its library: pip install "visitlab[minari]"'
_MAIN_FILE = "main_data.hdf5"
_ELSEWHERE = ("trial", "step", "state", "action", "reward")
"""Columns that are no infos."""


class Written(NamedTuple):
    """A data set: its id, its folder, how many episodes and steps it has."""

    dataset: str
    folder: Path
    episodes: int
    steps: int


def write_minari(root: Path, log: Path, numbers: Sequence[int] = ()) -> Written:
    """Write trials of a log, all recorded ones where no `numbers` are given, as a new data set below `root`.

    `root` is a folder of data sets as Minari's MINARI_DATASETS_PATH names one; it is made where it is not there.

    Raises:
        UsageError: the data set exists, or Minari is not installed.
        NotFoundError: there is no such log or trial.
        RunError: the log is damaged, or it cannot be written.
    """
    storage, spaces, h5py = _libraries()
    about = read_metadata(log)
    dataset = _id(about, log, numbers)
    target = root / dataset
    size = TASKS[about["task"]].size(lab_of_log(log))
    with new_folder(target) as folder:
        data = folder / "data"
        data.mkdir(parents=True)
        made = storage.new(data, spaces.Discrete(size.n_states), spaces.Discrete(size.n_actions))
        with h5py.File(data / _MAIN_FILE, "a", track_order=True) as file:
            write = _array_writer(h5py)
            episodes, steps = _write_episodes(file, write, whole_trials(log, _blocks(log, about["task"], numbers)))
        if not episodes:
            raise NotFoundError(f"{log}: no trial is recorded")
        told = {"dataset_id": dataset, "minari_version": version("minari"), "total_episodes": episodes}
        made.update_metadata(told | {"total_steps": steps, **_described(about, log)})
        made.update_metadata({"dataset_size": float(made.get_size())})
    return Written(dataset, target, episodes, steps)


def _libraries() -> tuple[Any, Any, Any]:
    """Minari's storage, Gymnasium's spaces, h5py."""
    try:
        import h5py
        from gymnasium import spaces
        from minari.dataset.minari_storage import MinariStorage
    except ImportError as error:
        raise UsageError(MISSING) from error
    return MinariStorage, spaces, h5py


def _id(about: dict[str, str], log: Path, numbers: Sequence[int]) -> str:
    """The data set's id: which task, cell, config and trials, in the letters that Minari takes."""
    words = [about["cell"] or log.stem, about.get("config_hash", ""), *(["trial"] if numbers else []), *numbers]
    name = re.sub(r"[^\w-]+", "-", "-".join(str(word) for word in words if word != ""), flags=re.ASCII)
    return f"{NAMESPACE}/{about['task']}/{name}-v0"


def _described(about: dict[str, str], log: Path) -> dict[str, str]:
    """What the metadata say of how the data came about, so far as the log tells."""
    words = f"the task '{about['task']}' of visitlab, simulated: {TASKS[about['task']].about}"
    known = [f"{name} {about[key]}" for name, key in _FACTS.items() if about.get(key)]
    told = {"description": "; ".join([words, *known])}
    with contextlib.suppress(LookupError, TypeError, AttributeError, ValueError):
        config = config_of_log(log)
        told["algorithm_name"] = str(config["agents"][player_of(config, about["cell"])]["kind"])
    return told


_FACTS = {"cell": "cell", "seed": "seed", "config": "config_hash", "version": "version"}


def _blocks(log: Path, task: str, numbers: Sequence[int]) -> Iterator[Columns]:
    lab = lab_of_log(log)
    for block in (read_trial(log, number) for number in numbers) if numbers else iter_steps(log):
        check_values(log, block, task, lab)
        yield block


def _array_writer(h5py: Any) -> Callable[[Any, str, npt.NDArray[Any]], None]:
    """A function that writes an array into a group under a name, a path: as `create_dataset`, in 0.4 of its time."""
    links, arrays = h5py.h5p.create(h5py.h5p.LINK_CREATE), h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    links.set_create_intermediate_group(True)
    arrays.set_obj_track_times(False)
    of_shape, all_of_it = cache(h5py.h5s.create_simple), h5py.h5s.ALL

    def write(group: Any, name: str, values: npt.NDArray[Any]) -> None:
        kind = h5py.h5t.py_create(values.dtype, logical=1)
        made = h5py.h5d.create(group.id, name.encode(), kind, of_shape(values.shape), arrays, links)
        made.write(all_of_it, all_of_it, np.ascontiguousarray(values))

    return write


def _write_episodes(
    file: Any, write: Callable[[Any, str, npt.NDArray[Any]], None], trials: Iterable[Columns]
) -> tuple[int, int]:
    """The number of episodes and of their steps."""
    episodes = total = 0
    for trial in trials:
        steps = len(trial["step"]) - 1
        if not steps:
            continue  # a cell ends where its steps do, maybe at a trial's start
        group = file.create_group(f"episode_{episodes}")
        group.attrs.update({"id": episodes, "total_steps": steps, "trial": int(trial["trial"][0])})
        arrays = {
            "observations": trial["state"].astype(np.int64),
            "actions": trial["action"][1:].astype(np.int64),
            "rewards": trial["reward"][1:],
            "terminations": np.zeros(steps, np.bool_),
            "truncations": np.arange(1, steps + 1) == steps,
        }
        infos = {f"infos/{name}": values for name, values in trial.items() if name not in _ELSEWHERE}
        for name, values in (arrays | infos).items():
            write(group, name, values)
        episodes, total = episodes + 1, total + steps
    return episodes, total
