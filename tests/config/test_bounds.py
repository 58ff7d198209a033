"""What a config may hold at most: all else is told at once, in one line that names the bound."""

import os
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.config.lab import LAB, Complain, Load, edited
from tests.faults.fuzz_yaml import fuzz
from visitlab_cli.config.loading import load
from visitlab_cli.errors import ConfigError, UsageError
from visitlab_cli.yaml.include import MOST_FILES
from visitlab_cli.yaml.reader import MOST_VALUES

AT_ONCE = 4.0  # seconds of CPU time; each of these took minutes or for ever


@contextmanager
def at_once() -> Iterator[None]:
    begun = time.process_time()
    yield
    assert time.process_time() - begun < AT_ONCE


def test_a_chain_of_a_thousand_files_ends_at_the_bound(folder: Path, complaint: Complain) -> None:
    for index in range(1000):
        (folder / f"{index}.yaml").write_text(f"include: [{(index + 1) % 1000}.yaml]\n")
    with at_once():
        (line,) = complaint(f"include: [0.yaml]\n{LAB}")
    last = MOST_FILES - 2
    assert line == (
        f"{last}.yaml:1:11: include: {last + 1}.yaml is one file too many; a config has at most {MOST_FILES}"
    )


def test_a_file_that_is_included_two_to_the_thirtieth_times_is_read_once(folder: Path, loaded: Load) -> None:
    for index in range(30):
        (folder / f"{index}.yaml").write_text(f"include: [{index + 1}.yaml, {index + 1}.yaml]\n")
    (folder / "30.yaml").write_text("interaction: {distances: [1, 2, 3, 4]}\n")
    with at_once():
        assert loaded(f"include: [0.yaml, 0.yaml]\n{LAB}").interaction.distances == (1, 2, 3, 4)


def test_a_file_is_the_same_by_every_name(folder: Path, complaint: Complain) -> None:
    (folder / "lab.yaml").write_text("")
    (folder / "soft.yaml").symlink_to("lab.yaml")
    os.link(folder / "lab.yaml", folder / "hard.yaml")
    assert complaint(f"include: [soft.yaml, ./hard.yaml]\n{LAB}") == [
        "lab.yaml:1:11: include: soft.yaml includes this file in turn",
        "lab.yaml:1:22: include: hard.yaml includes this file in turn",
    ]


def test_only_files_are_included(folder: Path, complaint: Complain) -> None:
    os.mkfifo(folder / "pipe")
    with at_once():
        lines = complaint(f"include: [pipe, /dev/zero, /dev/null, ., ~nobody-here/x, ~]\n{LAB}")
    assert lines == [
        "lab.yaml:1:11: include: pipe: a pipe or a device, not a file",
        "lab.yaml:1:17: include: /dev/zero: a pipe or a device, not a file",
        "lab.yaml:1:28: include: /dev/null: a pipe or a device, not a file",
        "lab.yaml:1:39: include: .: is a directory",
        "lab.yaml:1:42: include: ~nobody-here/x: no such file or directory",
        "lab.yaml:1:58: include.5: must be the name of a file",
    ]


def test_what_is_not_beside_a_file_is_taken_from_those_that_are_shipped(folder: Path, loaded: Load) -> None:
    included = f"include: [agents/built-in.yaml]\n{LAB}"
    assert "q_learning" in loaded(included).agents
    (folder / "agents").mkdir()
    (folder / "agents" / "built-in.yaml").write_text("agents: {near: {kind: random}}\n")
    agents = loaded(included).agents
    assert "near" in agents
    assert "q_learning" not in agents


def test_the_home_folder_has_its_sign(folder: Path, loaded: Load, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(folder / "home"))
    (folder / "home").mkdir()
    (folder / "home" / "near.yaml").write_text("interaction: {distances: [1, 2, 3, 4]}\n")
    assert loaded(f"include: [~/near.yaml]\n{LAB}").interaction.distances == (1, 2, 3, 4)


def test_large_files_and_many_values_are_bounded_together(folder: Path, complaint: Complain) -> None:
    for name in "abc":
        (folder / f"{name}.yaml").write_text(f"{name}: |\n" + "  x\n" * 120_000)
    assert complaint(f"include: [a.yaml, b.yaml, c.yaml]\n{LAB}") == [
        "c.yaml: with what includes it larger than 1 MiB; no config is"
    ]
    for name in "abc":
        (folder / f"{name}.yaml").write_text(f"{name}: [{'1, ' * (MOST_VALUES // 2)}]\n")
    (line,) = complaint(f"include: [a.yaml, b.yaml, c.yaml]\n{LAB}")
    assert line == f"b.yaml:1:1: with what includes it more than {MOST_VALUES} values"


def test_a_pipe_that_the_user_names_is_read_and_not_waited_for(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("visitlab_cli.yaml.files.PATIENCE", 0.1)
    reading, writing = os.pipe()
    os.write(writing, LAB.encode())
    os.close(writing)
    assert load(f"/dev/fd/{reading}").name == "lab"
    os.close(reading)
    os.mkfifo(folder / "pipe")
    with pytest.raises(ConfigError, match="pipe: nothing more came"):
        load("pipe")


def values(count: int) -> list[float]:
    return [(index + 1) / 1e6 for index in range(count)]


MANY = ", ".join(f"agents.mb.x{index}: {list(range(90))}" for index in range(60))
GRIDS = [
    (f"vary: {{agents.mb.epsilon: {values(200)}, agents.mf.alpha: {values(250)}}}", "a grid of 50000 points"),
    (f"vary: {{agents.mb.epsilon: {values(5000)}}}\nseeds: 10", "makes up to 400000 cells"),
    ("seeds: 50000", "makes up to 400000 cells"),
    (f"vary: {{{', '.join(f'agents.mb.x{index}: [1, 2]' for index in range(4000))}}}", "4000 paths"),
    (f"vary: {{{MANY}}}", "a grid of more than 1000000000000000 points"),
]


@pytest.mark.parametrize(("grid", "line"), GRIDS, ids=[line for _, line in GRIDS])
def test_a_large_grid_is_told_before_it_is_made(complaint: Complain, grid: str, line: str) -> None:
    with at_once():
        (told,) = complaint(f"{LAB}{grid}\n")
    assert f": {line}; at most " in told


def test_a_grid_over_a_large_config_counts_its_values(complaint: Complain) -> None:
    humans = "".join(f"  h{i}: {{p_S: [1, 0, 0]}}\n" for i in range(600))
    grid = f"vary: {{agents.mb.epsilon: {values(1000)}}}\n"
    with at_once():
        (line,) = complaint(edited("agents:\n", humans + "agents:\n") + grid)
    assert "all points together have" in line
    assert "at most 3000000" in line


def test_what_is_like_a_large_entry_is_bounded(complaint: Complain) -> None:
    large = "large: {" + ", ".join(f"a{i}: 1" for i in range(2000)) + "}"
    others = "".join(f"  l{i}: {{like: large}}\n" for i in range(2000))
    with at_once():
        lines = complaint(edited("agents:\n", f"{others}  {large}\nagents:\n"))
    assert any("all entries together take over more than" in line for line in lines)


@pytest.mark.parametrize(
    "text",
    [
        "\n".join(f"a{i}: 1" for i in range(9000)),
        LAB + "expected: {" + ", ".join(f"navigatio{i}/rmax: {{value: 1, tolerance: 1}}" for i in range(3000)) + "}",
        "agents: {" + ", ".join(f"a{i}: {{kind: q_learnin}}" for i in range(4000)) + "}",
        "experiments: {n: {task: navigation, agents: [" + ", ".join(f"a{i}" for i in range(9000)) + "]}}",
    ],
    ids=["keys", "expected", "kinds", "agents"],
)
def test_thousands_of_wrong_names_are_told_at_once(complaint: Complain, text: str) -> None:
    with at_once():
        lines = complaint(text)
    assert len(lines) <= 51
    assert all(len(line) < 1000 for line in lines)


def test_overrides_are_bounded() -> None:
    for overrides in (["seeds=1"] * 10_000, ["a." * 50_000 + "b=1"], ["a." * 90 + "b=1"]):
        with at_once(), pytest.raises((UsageError, ConfigError)) as error:
            load("quickstart", overrides)
        assert len(str(error.value)) < 1000


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("seed:\u00a0 3\nseeds: 1\n", "1:6: no-break space (U+00A0); YAML knows no other space than the usual one"),
        ("a: 1\n\u3000\nb: 2", "2:1: ideographic space (U+3000); YAML knows no other space than the usual one"),
        ("a: 1\n# x\u2028b: 2\n", "2:4: line separator (U+2028), which some take for a line break; remove it"),
        ("a: '\u2029'\n", "1:5: paragraph separator (U+2029), which some take for a line break; remove it"),
        ("a: 1\r\n# \u0085b: 2\n", "2:3: control character (U+0085), which some take for a line break; remove it"),
        ("a: 1\rb: @x", "2:4: text that starts with @ must be in quotes"),
        ("a: 1\r\n\tb: 1", "2:1: a tab; YAML is indented with spaces"),
    ],
)
def test_what_looks_like_a_space_or_a_line_break_is_named_where_it_is(
    complaint: Complain, text: str, line: str
) -> None:
    assert complaint(text) == [f"lab.yaml:{line}"]


def test_nothing_that_is_refused_takes_much_memory(tmp_path: Path) -> None:
    bombs = {
        "aliases": "a0: &a0 [x]\n" + "".join(f"a{n}: &a{n} [{f'*a{n - 1}, ' * 9}]\n" for n in range(1, 20)),
        "keys": "".join(f"a{i}: 1\n" for i in range(100_000)),
        "scalar": "a: " + "x" * 1_000_000,
        "depth": "[" * 1_000_000,
        "like": "humans:\n  l: {" + ", ".join(f"a{i}: 1" for i in range(9000)) + "}\n"
        + "".join(f"  l{i}: {{like: l}}\n" for i in range(3000)),
    }  # fmt: skip
    for name, text in bombs.items():
        (tmp_path / f"{name}.yaml").write_text(text)
    program = (
        "import resource, sys\n"
        "from visitlab_cli.config.loading import load\n"
        "from visitlab_cli.errors import ConfigError\n"
        "used = int(open('/proc/self/statm').read().split()[0]) * resource.getpagesize()\n"
        "resource.setrlimit(resource.RLIMIT_AS, (used + (256 << 20),) * 2)\n"
        "for name in sys.argv[1:]:\n"
        "    try:\n        load(name)\n"
        "    except ConfigError as error:\n        assert len(str(error)) < 20_000\n"
        "    else:\n        raise SystemExit(name)\n"
    )
    if not Path("/proc/self/statm").exists() or not hasattr(resource, "RLIMIT_AS"):
        pytest.skip("needs Linux")
    names = [str(tmp_path / f"{name}.yaml") for name in bombs]
    done = subprocess.run([sys.executable, "-c", program, *names], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_configs_that_nobody_would_write_are_loaded_or_refused() -> None:
    assert fuzz(300, seed=0) == []
