"""A command's place in the help pages, and its examples, which the tests run as they stand."""

import pkgutil
from collections.abc import Iterator
from importlib import import_module
from types import ModuleType
from typing import Any, NamedTuple

PANELS = ("Run", "Look", "Configure", "Runs")


class Help(NamedTuple):
    """What each module in `commands/` states as `HELP`, beside its function `command`.

    `panel` is one of `PANELS`, `place` the order within it, and `examples` are two lines as a user types them. A
    folder in `commands/` is a group of commands; its `summary` is the group's own help.
    """

    panel: str
    place: int = 100
    examples: tuple[str, ...] = ()
    summary: str = ""

    @property
    def epilog(self) -> str | None:
        """The end of a command's help page."""
        return "\n\n".join(["Examples:", *self.examples]) if self.examples else None


def commands_in(package: ModuleType) -> list[tuple[str, Any]]:
    """The modules in a folder of commands with the names of their commands, in the order of the help page."""
    names = [found.name for found in pkgutil.iter_modules(package.__path__)]
    modules = [(name, import_module(f"{package.__name__}.{name}")) for name in names]
    return sorted(modules, key=lambda each: (PANELS.index(each[1].HELP.panel), each[1].HELP.place, each[0]))


def examples_in(package: ModuleType, group: str = "") -> Iterator[tuple[str, tuple[str, ...]]]:
    """The examples of all commands in a folder, by the words of a command: `run`, `runs list`."""
    for name, module in commands_in(package):
        if hasattr(module, "__path__"):
            yield from examples_in(module, f"{name} ")
        else:
            yield f"{group}{name}", module.HELP.examples
