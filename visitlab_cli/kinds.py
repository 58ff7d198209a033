"""Kinds of something that a config declares, a class each, found in modules: how a folder or a plug-in adds one.

Which kind an entry is, its `kind` says. One kind may have no such word: an entry without `kind` is of that one.
"""

import importlib
import pkgutil
from collections.abc import Iterator, Mapping
from functools import cache
from inspect import isabstract
from types import ModuleType
from typing import Annotated, Any, ClassVar, Literal, TypeVar, Union, get_args

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from visitlab_cli.settings import Settings
from visitlab_cli.sources import is_others

KIND = "kind"
UNSAID = ""
"""Stands for the word of the kind that has none."""
REGISTRY = "registry"
"""The module of a folder of kinds that lists them."""


class Kind(Settings):
    """What all kinds share."""

    api: ClassVar[int] = 1
    """The number of visitlab's promises to kinds of others that it was written for."""

    absent: ClassVar[str] = ""
    """Why nothing can be simulated with it: it stands for a kind that is not installed here. Empty of all others."""

    never: ClassVar[Mapping[str, str]] = {}
    """Settings that others of its sort have and it can't, each with the reason."""

    @classmethod
    def compiled(cls) -> bool:
        """Whether what is simulated with it is kernels, not plain Python."""
        return True


Base = TypeVar("Base", bound=BaseModel)


def words_of(kind: type[BaseModel]) -> tuple[str, ...]:
    """The words that mean a kind."""
    field = kind.model_fields.get(KIND)
    return (UNSAID,) if field is None else get_args(field.annotation)


def kinds_in(module: ModuleType, base: type[Base]) -> Iterator[tuple[str, type[Base]]]:
    """The kinds that a module defines, subclasses of `base`, by their words; what is abstract is what some share."""
    for value in vars(module).values():
        if not isinstance(value, type) or not issubclass(value, base) or isabstract(value):
            continue
        if value.__module__ == module.__name__:
            is_others(str(module.__file__))
            yield from ((word, value) for word in words_of(value))


def built_in(folder: ModuleType, base: type[Base]) -> dict[str, type[Base]]:
    """The kinds in the modules of a package but for that of `base`, by their words."""
    names = [f"{folder.__name__}.{file.name}" for file in pkgutil.iter_modules(folder.__path__)]
    without = (base.__module__, f"{folder.__name__}.{REGISTRY}")
    modules = [importlib.import_module(name) for name in names if name not in without]
    return dict(found for module in modules for found in kinds_in(module, base))


def any_of(kinds: Mapping[str, type[BaseModel]]) -> Any:
    """The type of an entry that may be of each of these kinds, for pydantic."""
    classes = tuple(dict.fromkeys(kinds.values()))
    if len(classes) == 1:
        return classes[0]
    if UNSAID not in kinds:
        return Annotated[Union[classes], Field(discriminator=KIND)]  # noqa: UP007
    tagged = tuple(Annotated[each, Tag(word)] for word, each in kinds.items())
    return Annotated[Union[tagged], Discriminator(kind)]  # noqa: UP007


def kind(entry: Any) -> str:
    """The word of an entry, plain or made; called as the key, by which pydantic names it in its errors."""
    said = entry.get(KIND, UNSAID) if isinstance(entry, Mapping) else getattr(entry, KIND, UNSAID)
    return str(said)


@cache
def absent(base: type[Base], word: str, why: str) -> type[Base]:
    """What stands for a kind that is not to be had: it takes any settings and keeps them, and can't be simulated."""
    members: dict[str, Any] = {
        "__doc__": f"A kind that is not to be had: {why}.",
        "__module__": base.__module__,
        "__annotations__": {KIND: Literal[word]},
        "model_config": ConfigDict(extra="allow"),
        "absent": why,
    }
    make: Any = type(base)
    made: type[Base] = make("Absent", (base,), members)
    return made
