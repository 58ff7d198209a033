"""Every kind of agent, found by listing this folder: what the config, the loops and the documentation ask."""

import importlib
import pkgutil
from collections.abc import Iterator
from types import ModuleType
from typing import TYPE_CHECKING, Annotated, Union, get_args

from pydantic import Field

from visitlab_cli import agents
from visitlab_cli.agents.base import AgentParameters


def kinds_in(module: ModuleType) -> Iterator[tuple[str, type[AgentParameters]]]:
    """The kinds of agent that a module defines: each parameters' class by the word that `kind` takes."""
    for value in vars(module).values():
        if isinstance(value, type) and issubclass(value, AgentParameters) and value.__module__ == module.__name__:
            yield from ((word, value) for word in get_args(value.model_fields["kind"].annotation))


def _built_in() -> Iterator[tuple[str, type[AgentParameters]]]:
    for file in pkgutil.iter_modules(agents.__path__):
        name = f"{agents.__name__}.{file.name}"
        if name not in (__name__, AgentParameters.__module__):
            yield from kinds_in(importlib.import_module(name))


KINDS: dict[str, type[AgentParameters]] = dict(_built_in())
"""The parameters' class of each kind, by its name in a config."""

if TYPE_CHECKING:
    AnyAgent = AgentParameters
else:
    AnyAgent = Annotated[Union[tuple(KINDS.values())], Field(discriminator="kind")]  # noqa: UP007
