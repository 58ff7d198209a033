"""The rooms of the house: imports go down only, and heavy packages stay where they belong."""

import ast
from pathlib import Path

import pytest

import visitlab_cli

PACKAGE = Path(visitlab_cli.__file__).parent
FLOORS = [
    {"__init__", "errors", "settings", "sources", "stopping"},
    {"kinds", "origin", "surroundings", "terminal"},
    {"same_pictures", "whole_file", "whole_number", "wording"},
    {"yaml"},
    {"kernel_cache", "plugins"},
    {"compiled"},
    {"callbacks", "random_numbers"},
    {"world"},
    {"agents", "humans"},
    {"simulation"},
    {"config"},
    {"exact", "log"},
    {"storage"},
    {"plan"},
    {"execution"},
    {"jobs", "results"},
    {"authoring", "door", "playing"},
    {"colours", "scene", "pictures"},
    {"affordances"},
    {"paper"},
    {"export", "figures", "replay", "report"},
    {"scores"},
    {"console", "gym"},
    {"commands", "running"},
    {"cli"},
    {"__main__"},
]
FLOOR = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}
FRONT = ("__init__.py", "visitlab_cli.door")
"""The one way up: `visitlab_cli.load`, which opens the door only when it is called."""
LIGHT = {"typer", "visitlab_cli", "rich"}
STANDARD_BUT_SLOW = {"multiprocessing", "asyncio", "concurrent"}


def files(package):
    return sorted(package.rglob("*.py"))


def room_of(package, file):
    return file.relative_to(package).parts[0].removesuffix(".py")


def imports(file, whole=True, more=""):
    """The modules that a file, with `more` at its end, imports: anywhere in it, or only those that it loads at once."""
    tree = ast.parse(file.read_text() + more)
    nodes = ast.walk(tree) if whole else tree.body
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: relative import"
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def upward_imports(file, more=""):
    """Those of a file of the package, with `more` at its end."""
    here, name_of_file = room_of(PACKAGE, file), file.relative_to(PACKAGE).as_posix()
    for name in imports(file, more=more):
        parts = name.split(".")
        if parts[0] != "visitlab_cli" or (name_of_file, ".".join(parts[:2])) == FRONT:
            continue
        there = parts[1] if len(parts) > 1 and parts[1] in FLOOR else "__init__"
        beside = FLOOR[there] == FLOOR[here] and there != here
        if FLOOR[there] > FLOOR[here] or (beside and "__init__" not in (here, there)):
            yield f"{name_of_file}: {name}"


def test_every_room_has_its_floor():
    assert {room_of(PACKAGE, file) for file in files(PACKAGE)} <= set(FLOOR)


def test_imports_go_down_only():
    assert [found for file in files(PACKAGE) for found in upward_imports(file)] == []


@pytest.mark.parametrize(
    ("file", "line"),
    [
        ("world/human.py", "from visitlab_cli.agents.base import choose"),
        ("agents/rmax.py", "import visitlab_cli.simulation.loop"),
        ("storage/arrays.py", "def f():\n    from visitlab_cli.plan.cells import plan"),
        ("errors.py", "from visitlab_cli import cli"),
    ],
)
def test_an_upward_import_is_seen(file, line):
    assert [found.split(":")[0] for found in upward_imports(PACKAGE / file, f"\n{line}\n")]


def test_only_replay_imports_rerun():
    using = {room_of(PACKAGE, file) for file in files(PACKAGE) for name in imports(file) if name.startswith("rerun")}
    assert using <= {"replay"}


def test_only_those_who_ask_for_dask_load_it():
    own = {PACKAGE / "execution" / name for name in ("dask_cluster.py", "dask_here.py", "dask_worker.py")}
    loading = ("dask", "distributed", *(f"visitlab_cli.execution.{file.stem}" for file in own))
    others = [file for file in files(PACKAGE) if file not in own]
    assert [(file, name) for file in others for name in imports(file, whole=False) if name.startswith(loading)] == []


def test_commands_load_nothing_heavy():
    import sys

    for file in [*files(PACKAGE / "commands"), *files(PACKAGE / "console"), PACKAGE / "cli.py", PACKAGE / "errors.py"]:
        for name in imports(file, whole=False):
            top = name.split(".")[0]
            assert top in LIGHT or (top in sys.stdlib_module_names and top not in STANDARD_BUT_SLOW), (file, name)
            if top == "visitlab_cli":
                assert name in {"visitlab_cli", "visitlab_cli.__version__"} or name.split(".")[1] in {
                    "commands",
                    "console",
                    "errors",
                    "stopping",
                    "terminal",
                }, (file, name)


def test_the_page_names_every_room():
    page = (PACKAGE.parent / "docs" / "architecture.md").read_text()
    table = page[page.index("| room | job |") : page.index("## Three paths")]
    rows = (line.split("|")[1] for line in table.splitlines()[2:] if line.startswith("|"))
    told = {name.strip("`/ ").split("/")[0] for row in rows for name in row.split(",")}
    assert told == set(FLOOR) - {"__init__", "__main__"}
