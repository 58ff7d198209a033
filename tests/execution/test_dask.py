"""Cells in the workers of a Dask cluster: the same bytes, and a line for each thing that may be wrong with one."""

import gc
import os
import pickle
import shutil
import signal
import subprocess
import time
from types import SimpleNamespace

import pytest

from tests.dask_cluster import Cluster, until
from tests.faults.bench import members_of
from tests.program import TINY, hashes, new_process, start, the_run, visitlab
from visitlab_cli.config.loading import load
from visitlab_cli.errors import Interrupted, NotFoundError, RunError, UsageError
from visitlab_cli.execution import dask_cluster, dask_worker
from visitlab_cli.execution.dask_address import At, is_exposed
from visitlab_cli.execution.dask_cluster import AHEAD, DaskPool
from visitlab_cli.execution.executor import OUT_OF_MEMORY
from visitlab_cli.execution.progress import Progress
from visitlab_cli.execution.runner import run_cells
from visitlab_cli.execution.workers import OtherCodeError, Workers
from visitlab_cli.plan.cells import plan
from visitlab_cli.plugins import VARIABLE

AGENT = """
import os
import time
from typing import Literal
import numpy as np
from visitlab_cli import AgentParameters

class Parameters(AgentParameters):
    kind: Literal["theirs"]
    does: Literal["nothing", "raise", "die"] = "nothing"

    def agent(self, setting):
        if self.does == "raise":
            raise ZeroDivisionError("no such thing")
        if self.does == "die":
            os._exit(9)
        return Agent(setting)

class Agent:
    def __init__(self, setting):
        self.n = setting.n_actions
    def act(self, state, random, step):
        return int(random.integers(self.n))
    def learn(self, *transition):
        pass
    def arrays(self):
        return {"table": np.zeros(2)}
    def restore(self, arrays):
        pass
"""
CONFIG = """
name: dask
seeds: 3
agents: {mf: {kind: q_learning}, good: {kind: theirs}, bad: {kind: theirs, does: DOES}}
experiments: {navigation: {task: navigation, agents: [mf, good, bad], steps: STEPS}}
"""
NAVIGATION = "experiments={navigation: {task: navigation, agents: [mf, chance], steps: 200}}"
UNCOMPILED = {"NUMBA_DISABLE_JIT": "1"}
LONG = 5_000_000


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    with Cluster(tmp_path_factory.mktemp("dask"), **UNCOMPILED) as cluster:
        cluster.add_worker()
        cluster.add_worker()
        yield cluster


@pytest.fixture
def cells(tmp_path, monkeypatch):
    """Makes cells of which some are an agent's in a file that is a plug-in."""
    plugin = tmp_path / "theirs.py"
    plugin.write_text(AGENT)
    monkeypatch.setenv(VARIABLE, str(plugin))

    def made(does="nothing", steps=60):
        file = tmp_path / "dask.yaml"
        file.write_text(CONFIG.replace("DOES", does).replace("STEPS", str(steps)))
        return plan(load(file))

    return made


@pytest.fixture
def pool(cluster, tmp_path):
    """Opens the cluster for the cells of a run."""
    opened = []

    def connected(cells, run=tmp_path / "run", warn=lambda line: None):
        run.mkdir(exist_ok=True)
        until(lambda: len(cluster.nannies) >= 2)
        opened.append(
            DaskPool(At(cluster.address), 0, run, {kind for cell in cells for kind in cell.config.kinds}, warn)
        )
        until(lambda: (opened[-1].count, opened[-1].workers)[1] >= 2)
        return opened[-1]

    yield connected
    for each in opened:
        each.close()


def test_the_same_bytes_as_local_workers_with_a_plug_in(cells, pool, tmp_path):
    assert run_cells(tmp_path / "run", cells(), 2, Progress(quiet=True), lambda count: pool(cells())) == {}
    assert run_cells(tmp_path / "local", cells(), 1, Progress(quiet=True)) == {}
    assert hashes(tmp_path / "run") == hashes(tmp_path / "local")
    assert len(hashes(tmp_path / "local")) == 9 * 4


def test_an_exception_fails_its_cell_alone(cells, pool, tmp_path):
    failures = run_cells(tmp_path / "run", cells("raise"), 2, Progress(quiet=True), lambda count: pool(cells("raise")))
    assert {path.split("/")[1] for path in failures} == {"bad"}
    assert all("ZeroDivisionError: no such thing" in line for line in failures.values())
    assert len(list((tmp_path / "run").rglob("cell.json"))) == 6


@pytest.mark.parametrize("name", ["python", "numba", dask_worker.CODE])
def test_other_versions_and_other_code_are_refused_by_name(name, cells, pool, monkeypatch):
    facts = dask_cluster.facts
    monkeypatch.setattr(dask_cluster, "facts", lambda kinds=(): {**facts(kinds), name: "of old"})
    with pytest.raises(
        OtherCodeError, match=rf"^worker tcp://127\.0\.0\.1:\d+ has {name} \S+, this program of old"
    ) as no:
        pool(cells())
    assert no.value.exit_code == 4


def test_steps_are_told_and_a_cell_stops_after_its_block(cells, pool, tmp_path):
    (cell, *_) = cells(steps=LONG)
    opened = pool([cell])
    future = opened.submit(tmp_path / "run", cell, 0)
    until(lambda: opened.steps_done(0) > 0)
    assert opened.place(0).startswith("worker tcp://127.0.0.1:")
    opened.stop()
    assert isinstance(future.exception(timeout=30), Interrupted)
    until(lambda: not list((tmp_path / "run").glob(".tmp-dask*")))
    assert not list((tmp_path / "run").rglob("cell.json"))
    opened.close()
    assert not list((tmp_path / "run").glob(".tmp-probe-*"))


@pytest.mark.slow
def test_a_worker_that_joins_later_is_used_if_it_is_as_the_program(cells, cluster, pool, tmp_path, monkeypatch):
    opened = pool(cells())
    before = opened.count
    assert before == AHEAD * opened.workers
    late = cluster.add_worker()
    until(lambda: opened.count == before + AHEAD)
    os.killpg(late.pid, signal.SIGKILL)
    until(lambda: opened.count == before)
    opened._terms = opened._terms._replace(token="another", facts={**opened._terms.facts, "numba": "of old"})
    (cell, *_) = cells()
    with pytest.raises(OtherCodeError, match="has numba"):
        opened.submit(tmp_path / "run", cell, 0).result(timeout=30)


@pytest.mark.parametrize(
    ("change", "threads", "said"),
    [
        ({}, 1, ""),
        ({}, 4, "has 4 threads; start it with --nthreads 1"),
        ({"token": "u"}, 1, "does not see "),
        ({"probe": "/nowhere/at/all"}, 1, "does not see /nowhere/at"),
        ({"plugins": ("/nowhere.py",)}, 1, "can't import what the config names: /nowhere.py: no such file"),
        ({"kinds": b"cnowhere\nKind\n."}, 1, "can't import what the config names: ModuleNotFoundError: No module"),
        ({"with_kinds": {}}, 1, "has visitlab "),
    ],
)
def test_what_a_worker_says_that_is_not_as_the_program(change, threads, said, tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_NUM_THREADS", "1")
    monkeypatch.setenv(VARIABLE, "")
    (tmp_path / "probe").write_text('{"token": "t"}')
    facts = dask_worker.facts()
    terms = dask_worker.Terms("t", facts, str(tmp_path / "probe"), (), pickle.dumps([]), facts)._replace(**change)
    worker = SimpleNamespace(state=SimpleNamespace(nthreads=threads))
    told = dask_worker.difference(terms, worker) or dask_worker._difference_of_kinds(terms)
    assert told.startswith(said)
    assert bool(told) == bool(said)
    assert "\n" not in told


@pytest.mark.parametrize(
    ("address", "exposed"),
    [
        ("tcp://127.0.0.1:8786", False),
        ("tcp://[::1]:8786", False),
        ("tcp://localhost:8786", False),
        ("tls://10.1.2.3:8786", False),
        ("tcp://10.1.2.3:8786", True),
        ("tcp://node1:8786", True),
        ("tcp://0.0.0.0:8786", True),
        ("ucx://10.1.2.3:8786", True),
    ],
)
def test_a_port_that_others_reach_unencrypted_is_told(address, exposed):
    assert is_exposed(address) == exposed


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "tls://127.0.0.1:1"])
def test_nothing_answers(address, tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(dask_cluster, "CONNECT_SECONDS", 0.3)
    begun = time.monotonic()
    with pytest.raises(RunError, match=rf"^{address}: no Dask scheduler answers: ") as told:
        DaskPool(At(address), 0, tmp_path, [], print)
    assert "\n" not in str(told.value)
    del told
    gc.collect()
    assert time.monotonic() - begun < 20
    assert "Traceback" not in capfd.readouterr().err


def test_files_that_are_no_schedulers(tmp_path):
    with pytest.raises(NotFoundError, match="no such file"):
        At("", tmp_path / "none").resolved()
    for number, text in enumerate(["", "[]", "{}", '{"address": 5}', '{"address": "http://x"}']):
        (tmp_path / str(number)).write_text(text)
        with pytest.raises(RunError, match="is no scheduler file of Dask"):
            At("", tmp_path / str(number)).resolved()


@pytest.mark.parametrize(
    "address",
    [
        *("127.0.0.1:8786", "http://127.0.0.1:80", "tcp://a b:1", "tcp://x:1\n", "tcp://x", "tcp://x:", "tcp://:1"),
        *("tcp://x:0", "tcp://x:65536", "tcp://x:99999", "tcp://x:٣", "tcp://1.2.3:1", "tcp://1.2.3.456:1"),
        *("tcp://-x:1", "tcp://a..b:1", "tcp://.:1", "tcp://[::1:1", "tcp://[1::2::3]:1", "tcp://[x]:1"),
    ],
)
def test_what_can_be_no_address_is_not_waited_for(address):
    with pytest.raises(UsageError, match="must be tcp://HOST:PORT or tls://HOST:PORT, with a port from 1 to 65535"):
        At(address).resolved()


@pytest.mark.parametrize(
    "address", ["tcp://x:1", "tls://node_1.lab-2.org:65535", "tcp://10.0.0.1:8786", "tcp://[::1]:1"]
)
def test_what_can_be_an_address_is_one(address):
    assert At(address).resolved() == address


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--address", "tcp://127.0.0.1:1"], "--address: add --executor dask"),
        (["--executor", "dask", "--address", "tcp://a:1", "--scheduler-file", "x"], "choose one"),
        (["--executor", "dask", "--address", "tcp://a:1", "--workers", "2"], "has workers of its own"),
        (["--executor", "dask", "--address", "a:1"], "must be tcp://HOST:PORT"),
        (["--executor", "ray"], "ray"),
    ],
)
def test_options_that_mean_nothing_together(options, said, tmp_path):
    for command in ("run", "train"):
        done = visitlab(command, TINY, "--out", tmp_path, *options)
        assert done.returncode == 2
        assert said in done.stderr


def test_without_dask_a_line_says_what_to_install(tmp_path):
    (tmp_path / "distributed.py").write_text("raise ImportError\n")
    env = {"PYTHONPATH": str(tmp_path)}
    done = new_process("run", TINY, "--out", tmp_path / "runs", "--executor", "dask", env=env)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == '--executor dask needs Dask: pip install "visitlab[cluster]"'


def test_a_cluster_of_ones_own_ends_with_the_command(tmp_path):
    words = "run", TINY, NAVIGATION, "--out"
    done = new_process(*words, tmp_path / "dask", "--executor", "dask", "--workers", "2", env=UNCOMPILED)
    assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stderr
    assert visitlab(*words, tmp_path / "local", "--workers", "1").returncode == 0
    assert hashes(the_run(tmp_path / "dask")) == hashes(the_run(tmp_path / "local"))


@pytest.mark.slow
def test_a_cell_that_kills_its_workers_is_given_up_and_it_alone(cells, pool, tmp_path):
    failures = run_cells(tmp_path / "run", cells("die"), 2, Progress(quiet=True), lambda count: pool(cells("die")))
    assert failures == {f"navigation/bad/seed-000{seed}": OUT_OF_MEMORY for seed in range(3)}
    assert len(list((tmp_path / "run").rglob("cell.json"))) == 6


@pytest.mark.slow
@pytest.mark.parametrize("twice", [False, True])
def test_interrupted_a_cluster_of_ones_own_ends_too(tmp_path, twice):
    words = "run", TINY, NAVIGATION.replace("200", str(LONG)), "--out", tmp_path, "--executor", "dask", "--workers", "2"
    program = start(*words, env=UNCOMPILED)
    until(lambda: list(tmp_path.glob("*/.tmp-nav*")))
    begun = time.monotonic()
    os.killpg(program.pid, signal.SIGINT)
    if twice:
        time.sleep(0.2)
        os.killpg(program.pid, signal.SIGINT)
    _, told = program.communicate(timeout=60)
    assert program.returncode == 130
    assert told.splitlines()[-1].startswith("interrupted; what was finished is kept")
    assert "Traceback" not in told
    assert time.monotonic() - begun < 30
    until(lambda: not members_of(program.pid))


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("openssl") is None, reason="there is no openssl")
def test_tls_is_dasks_own_and_is_heeded(tmp_path):
    command = [
        "openssl",
        "req",
        "-x509",
        "-newkey",
        "rsa:2048",
        "-nodes",
        "-keyout",
        "key",
        "-out",
        "cert",
        "-days",
        "2",
    ]
    subprocess.run([*command, "-subj", "/CN=visitlab"], cwd=tmp_path, check=True, capture_output=True)
    tls, cert, key = "DASK_DISTRIBUTED__COMM__TLS__", str(tmp_path / "cert"), str(tmp_path / "key")
    env = {"DASK_DISTRIBUTED__COMM__REQUIRE_ENCRYPTION": "true", f"{tls}CA_FILE": cert}
    for who in ("SCHEDULER", "WORKER", "CLIENT"):
        env |= {f"{tls}{who}__CERT": cert, f"{tls}{who}__KEY": key}
    with Cluster(tmp_path, **UNCOMPILED, **env) as cluster:
        cluster.add_worker()
        assert cluster.address.startswith("tls://")
        words = (
            "run",
            TINY,
            NAVIGATION,
            "--executor",
            "dask",
            "--scheduler-file",
            cluster.file,
            "--out",
            tmp_path / "runs",
        )
        done = new_process(*words, env=env | UNCOMPILED)
        assert done.returncode == 0, done.stderr
        assert "whoever reaches" not in done.stderr
        own = new_process(
            "run", TINY, NAVIGATION, "--executor", "dask", "--out", tmp_path / "own", env=env | UNCOMPILED
        )
        assert own.returncode == 0, own.stderr


def test_local_workers_say_where_a_cell_runs():
    assert Workers(2).place(1) == "worker 2, process 0"
