"""The Minari export, read back by Minari's own loader."""

import numpy as np
import pytest

from tests.program import visitlab
from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.export.minari import write_minari
from visitlab_cli.log.reader import iter_steps, read_metadata, read_steps, read_trial, whole_trials
from visitlab_cli.storage.cell_folder import STEPS

minari = pytest.importorskip("minari")
CELLS = {"navigation": "navigation/rmax", "social": "social/script/fast", "visit": "visit/fast"}


def log_of(tiny_run, cell):
    return tiny_run / cell / "seed-0000" / STEPS


@pytest.fixture(scope="module")
def visit(tiny_run, tmp_path_factory):
    """The log, and the data set as its loader gives it."""
    log = log_of(tiny_run, CELLS["visit"])
    written = write_minari(tmp_path_factory.mktemp("minari"), log)
    return log, written, minari.MinariDataset(written.folder / "data")


def test_every_episode_is_its_trial(visit):
    log, written, dataset = visit
    steps = read_steps(log)
    assert (dataset.total_episodes, dataset.total_steps) == (written.episodes, written.steps)
    assert dataset.total_steps == np.count_nonzero(steps["step"])
    assert dataset.total_episodes == len(np.unique(steps["trial"]))
    for number, episode in enumerate(dataset.iterate_episodes()):
        trial = read_trial(log, number)
        assert len(episode) == len(trial["step"]) - 1
        assert np.array_equal(episode.observations, trial["state"])
        assert np.array_equal(episode.actions, trial["action"][1:])
        assert np.array_equal(episode.rewards, trial["reward"][1:])
        assert episode.infos.keys() == trial.keys() - {"trial", "step", "state", "action", "reward"}
        assert all(np.array_equal(values, trial[name]) for name, values in episode.infos.items())


def test_the_time_limit_truncates_and_nothing_terminates(visit):
    *_, dataset = visit
    for episode in dataset.iterate_episodes():
        assert not episode.terminations.any()
        assert np.flatnonzero(episode.truncations).tolist() == [len(episode) - 1]


def test_spaces_hold_what_is_in_it_and_the_metadata_say_what_it_is(visit):
    log, written, dataset = visit
    assert (dataset.observation_space.n, dataset.action_space.n) == (2560, 30)
    [episode] = dataset.sample_episodes(1)
    assert all(dataset.observation_space.contains(state) for state in episode.observations)
    assert all(dataset.action_space.contains(action) for action in episode.actions)
    told = dataset.storage.metadata
    assert told["dataset_id"] == written.dataset
    assert written.dataset.startswith("visitlab/visit/visit-fast-seed-0000-")
    assert told["algorithm_name"] == "model_based"
    assert read_metadata(log)["config_hash"] in told["description"]
    assert not told.keys() & {"env_spec", "author", "code_permalink"}  # nothing is claimed that is not known
    assert written.folder.joinpath("data", "main_data.hdf5").stat().st_size / 1e6 <= told["dataset_size"] + 0.1


def test_minari_finds_it_by_its_id_where_the_command_put_it(tiny_run, tmp_path, monkeypatch):
    done = visitlab("export", tiny_run, "--minari", "-e", "social", "--trial", 3, "--trial", 1, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "minari"))
    [name] = minari.list_local_datasets()
    dataset = minari.load_dataset(name)
    rewards = [episode.rewards for episode in dataset.iterate_episodes()]
    log = log_of(tiny_run, name.split("/")[2].partition("-seed")[0].replace("-", "/", 2))
    assert all(map(np.array_equal, rewards, [read_trial(log, number)["reward"][1:] for number in (3, 1)]))
    again = visitlab("export", tiny_run, "--minari", "-e", "social", "--trial", 3, "--trial", 1, cwd=tmp_path)
    assert (again.returncode, again.stdout) == (2, "")
    assert again.stderr.splitlines()[-1].endswith(f"minari/{name}: exists; choose another folder with -o")


def test_a_failure_leaves_no_data_set(tiny_run, tmp_path, monkeypatch):
    monkeypatch.setattr("visitlab_cli.export.minari.check_values", lambda *_: (_ for _ in ()).throw(RunError("wrong")))
    with pytest.raises(RunError, match="wrong"):
        write_minari(tmp_path, log_of(tiny_run, CELLS["navigation"]))
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_without_the_library_it_says_what_to_install(tiny_run, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "h5py", None)
    with pytest.raises(UsageError, match=r'pip install "visitlab\[minari\]"$'):
        write_minari(tmp_path, log_of(tiny_run, CELLS["navigation"]))


@pytest.mark.parametrize("size", [1, 7, 21, 50, 10_000])
def test_trials_come_whole_from_blocks_of_any_size(tiny_run, size):
    log = log_of(tiny_run, CELLS["navigation"])
    steps = read_steps(log)
    blocks = (
        {name: values[start : start + size] for name, values in steps.items()}
        for start in range(0, len(steps["step"]), size)
    )
    for number, trial in enumerate(whole_trials(log, blocks)):
        assert all(map(np.array_equal, trial.values(), read_trial(log, number).values()))
    assert number == steps["trial"][-1]


@pytest.mark.parametrize("lost", [0, 10])
def test_a_trial_that_lacks_a_part_is_named(tiny_run, lost):
    log = log_of(tiny_run, CELLS["navigation"])
    block = next(iter(iter_steps(log)))
    parts = ({name: np.delete(values, lost) for name, values in block.items()} for _ in range(1))
    with pytest.raises(RunError, match=rf"trial 0 lacks what comes before its step {lost + 1}$"):
        list(whole_trials(log, parts))
