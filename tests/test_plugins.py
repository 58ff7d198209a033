"""Kinds of other people: found by what is installed, imported when named, told in a line when something is wrong."""

import json
import os
import re

import pytest

from tests.program import the_run, visitlab

AGENT = """
from typing import Literal

import numpy as np

from visitlab_cli import AgentParameters


class Parameters(AgentParameters):
    kind: Literal["theirs"]

    def agent(self, setting):
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
name: others
agents: {a: {kind: theirs}}
experiments: {navigation: {task: navigation, agents: [a], steps: 400}}
"""


def package(folder, name="pack", source=AGENT, entries="theirs = {name}:Parameters", version="1.0", group="agents"):
    """A package as pip would have installed it into a folder."""
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.py").write_text(source)
    about = folder / f"{name}-{version}.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    (about / "entry_points.txt").write_text(f"[visitlab.{group}]\n{entries.format(name=name)}\n")
    return {"PYTHONPATH": str(folder)}


@pytest.fixture
def config(tmp_path):
    file = tmp_path / "others.yaml"
    file.write_text(CONFIG)
    return file


def test_a_package_is_imported_when_it_is_named_and_only_then(tmp_path, config):
    noisy = AGENT + f"\nopen({str(tmp_path / 'imported')!r}, 'a').write('x')\n"
    env = package(tmp_path / "site", source=noisy)
    plain = tmp_path / "plain.yaml"
    plain.write_text(CONFIG.replace("theirs", "q_learning"))
    for command in (["--help"], ["validate", plain], ["run", plain, "--dry-run"], ["schema"], ["humans"]):
        assert visitlab(*command, env=env, cwd=tmp_path).returncode == 0
    assert not (tmp_path / "imported").exists()
    assert visitlab("validate", config, env=env).returncode == 0
    assert (tmp_path / "imported").exists()


WRONG = {
    "missing": (None, "; for one of somebody else's install its package, or name its file by --plugin"),
    "raising": (
        {"source": "1 / 0"},
        "theirs, of pack 1.0, can't be imported: ZeroDivisionError: division by zero; mend it",
    ),
    "leaving": ({"source": "raise SystemExit(3)"}, "theirs, of pack 1.0, can't be imported: SystemExit: 3"),
    "without it": (
        {"source": ""},
        "theirs, of pack 1.0, can't be imported: AttributeError: module 'pack' has no attribute",
    ),
    "no class": (
        {"source": "Parameters = 7"},
        "theirs, of pack 1.0, is not a subclass of AgentParameters whose kind is",
    ),
    "of another name": (
        {"source": AGENT.replace("theirs", "other")},
        "is not a subclass of AgentParameters whose kind is",
    ),
    "of another API": (
        {"source": AGENT.replace("    kind:", "    api = 99\n    kind:")},
        "theirs, of pack 1.0, was written for API 99; this visitlab has API 1: install another version of pack or of",
    ),
}


@pytest.mark.parametrize(("options", "line"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_with_one_is_a_line_that_names_it(tmp_path, config, options, line):
    env = {} if options is None else package(tmp_path / "site", **options)
    for command in (["validate", config], ["run", config, "--out", tmp_path / "runs"]):
        done = visitlab(*command, env=env)
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (3, "", 1), done.stderr
        assert line in done.stderr
        assert re.match(rf"{re.escape(str(config))}:3:\d+: agents\.a\.kind: ", done.stderr)
    assert not (tmp_path / "runs").exists()
    listed = visitlab("agents", "--json", env=env)
    assert listed.returncode == 0
    if options is not None:
        (theirs,) = [each for each in json.loads(listed.stdout)["agents"] if each["package"] == "pack"]
        assert line in theirs["error"]


def test_two_packages_with_one_kind_are_both_named(tmp_path, config):
    package(tmp_path / "site", "one")
    env = package(tmp_path / "site", "two", version="2.0")
    done = visitlab("validate", config, env=env)
    assert done.returncode == 3
    assert "theirs is declared by one 1.0 and two 2.0; uninstall, or leave out, all but one" in done.stderr
    plain = config.with_name("plain.yaml")
    plain.write_text(CONFIG.replace("theirs", "q_learning"))
    assert visitlab("validate", plain, env=env).returncode == 0


def test_a_package_that_takes_a_word_of_ours_changes_nothing_and_is_told(tmp_path, config):
    config.write_text(CONFIG.replace("theirs", "q_learning"))
    env = package(
        tmp_path / "site", source=AGENT.replace("theirs", "q_learning"), entries="q_learning = pack:Parameters"
    )
    assert visitlab("validate", config, env=env).returncode == 0
    listed = json.loads(visitlab("agents", "--json", env=env).stdout)["agents"]
    (theirs,) = [each for each in listed if each["package"] == "pack"]
    assert theirs["error"] == "q_learning is a kind of visitlab's own; it needs another name"


def test_an_edited_one_is_other_code_and_going_on_with_it_is_told(tmp_path, config):
    env = package(tmp_path / "site")
    done = visitlab("run", config, "--out", tmp_path / "runs", env=env)
    assert done.returncode == 0, done.stderr
    run = the_run(tmp_path / "runs")
    first = json.loads((run / "navigation/a/seed-0000/cell.json").read_text())
    (tmp_path / "site" / "pack.py").write_text(AGENT.replace("random.integers(self.n)", "random.integers(2)"))
    done = visitlab("run", config, "seeds=2", "--out", tmp_path / "runs", env=env)
    assert done.returncode == 0, done.stderr
    second = json.loads((run / "navigation/a/seed-0001/cell.json").read_text())
    assert first["sources"] != second["sources"]
    assert "1 cell made by other code" in done.stderr
    assert "made by different code" in visitlab("runs", "verify", run).stdout


def test_a_file_is_named_by_the_command_or_the_variable_never_by_the_config(tmp_path, config):
    file = tmp_path / "mine.py"
    file.write_text(AGENT)
    for arguments, env in ((["--plugin", file], {}), ([], {"VISITLAB_PLUGINS": str(file)})):
        done = visitlab("validate", config, *arguments, env=env)
        assert done.returncode == 0, done.stderr
    config.write_text(CONFIG.replace("kind: theirs", "kind: theirs, plugin: mine.py"))
    assert "unknown" in visitlab("validate", config, "--plugin", file).stderr
    for wrong, code, line in (
        (tmp_path / "none.py", 5, f"{tmp_path / 'none.py'}: no such file, named as a plug-in\n"),
        (config, 2, "a plug-in's file is a Python module: letters, digits, _, then .py\n"),
    ):
        done = visitlab("validate", config, "--plugin", wrong)
        assert (done.returncode, done.stderr.count("\n")) == (code, 1)
        assert done.stderr.endswith(line)
    file.write_text("import nothing_of_that_name")
    done = visitlab("validate", config, "--plugin", file)
    assert done.returncode == 3
    assert (
        f"{file} can't be imported: ModuleNotFoundError: No module named 'nothing_of_that_name'; mend it" in done.stderr
    )
    assert os.environ.get("VISITLAB_PLUGINS") is None


UNUSABLE = {
    "a word of ours": (
        AGENT.replace("theirs", "q_learning"),
        "{file}: q_learning is a kind of visitlab's own; it",
    ),
    "what some share": (
        "from typing import Literal\nfrom visitlab_cli import HumanParameters\n"
        "class Mine(HumanParameters):\n    other: int = 0\n",
        "{file}: declares no kind: no class in it is a subclass of HumanParameters or AgentParameters",
    ),
    "no such class": ("class Parameters:\n    pass\n", "{file}: declares no kind"),
    "no word": (AGENT.replace('Literal["theirs"]', "str"), "{file}: declares no kind"),
    "not imported": ("import nothing_of_that_name", "{file} can't be imported: ModuleNotFoundError"),
}


@pytest.mark.parametrize(("source", "line"), UNUSABLE.values(), ids=UNUSABLE)
def test_a_file_that_is_of_no_use_is_told_whatever_the_config_names(tmp_path, config, source, line):
    config.write_text(CONFIG.replace("theirs", "q_learning"))
    file = tmp_path / "mine.py"
    file.write_text(source)
    told = line.format(file=file)
    for command in (["validate", config], ["run", config, "--dry-run"], ["plugin", "check", "q_learning"]):
        done = visitlab(*command, "--plugin", file)
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (3, "", 1), done.stderr
        assert done.stderr.startswith(told)
    listed = visitlab("agents", "--json", "--plugin", file)
    assert listed.returncode == 0, listed.stderr
    (theirs,) = [each for each in json.loads(listed.stdout)["agents"] if each["package"] == str(file)]
    assert told.removeprefix(f"{file}: ") in theirs["error"]


@pytest.mark.parametrize("section", ["agents", "humans"])
def test_a_compiled_kind_that_raises_when_it_is_made_fails_in_its_cells_alone(tmp_path, section):
    base, theirs = {
        "agents": ("visitlab_cli.agents.q_learning.QLearningParameters", "agents: [theirs, mf], humans: [ours]"),
        "humans": ("visitlab_cli.humans.six_parameters.SixParameters", "agents: [mf], humans: [theirs, ours]"),
    }[section]
    module, _, name = base.rpartition(".")
    file = tmp_path / "mine.py"
    file.write_text(
        f"from typing import Literal\nfrom {module} import {name}\n\n\nclass Mine({name}):\n"
        '    kind: Literal["theirs"]\n\n    def create(self, *setting):\n        raise KeyError("lost")\n'
    )
    who = {"agents": {"mf": "{kind: q_learning}"}, "humans": {"ours": "{p_S: [1, 0, 0]}"}}
    who[section]["theirs"] = "{kind: theirs}" if section == "agents" else "{kind: theirs, p_S: [1, 0, 0]}"
    told = [f"{name}: {{{', '.join(f'{key}: {value}' for key, value in each.items())}}}" for name, each in who.items()]
    config = tmp_path / "others.yaml"
    config.write_text(
        "\n".join(["name: others", *told, f"experiments: {{s: {{task: social, {theirs}, steps: 2000}}}}"])
    )
    done = visitlab("run", config, "--plugin", file, "--out", tmp_path / "runs", "--workers", 1)
    assert (done.returncode, "Traceback" in done.stderr) == (4, False), done.stderr
    run = the_run(tmp_path / "runs")
    (kept,) = (run / "failures").iterdir()
    assert "KeyError: 'lost'" in kept.read_text()
    assert (run / "s/mf/ours/seed-0000/cell.json").exists()
