"""Where kinds of other people lie: packages that declare them, files that a command names. Imported when named.

A package declares a kind by an entry point, in the group `visitlab.agents` or `visitlab.humans`, whose name is the
word that a config has for it. A file that is in no package is named by `--plugin`, or in VISITLAB_PLUGINS; a config
never names one, for else who shares a config would share code.
"""

import hashlib
import importlib.util
import os
import sys
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import NamedTuple, TypeVar

from pydantic import BaseModel

from visitlab_cli.errors import NotFoundError, UsageError
from visitlab_cli.kinds import UNSAID, kinds_in, words_of
from visitlab_cli.sources import is_others
from visitlab_cli.terminal import to_stderr
from visitlab_cli.wording import printable

API = 1
"""The number of what this version promises to kinds of others; a kind may say for which it was written, by `api`."""
VARIABLE = "VISITLAB_PLUGINS"
OURS = "visitlab"
GROUPS = {"agents": "visitlab.agents", "humans": "visitlab.humans"}

Base = TypeVar("Base", bound=BaseModel)


class PluginError(Exception):
    """A kind of somebody else can't be had; the message says whose it is and what to do."""


class NoSuchKindError(PluginError):
    """Nobody declares a kind."""


class Source(NamedTuple):
    """Who declares a kind: a package of a version, or a file, which has none."""

    word: str
    package: str
    version: str
    entry: EntryPoint | None

    def __str__(self) -> str:
        return " ".join(filter(None, (self.package, self.version)))


def files() -> list[Path]:
    """The files that are named as plug-ins."""
    return [Path(name) for name in os.environ.get(VARIABLE, "").split(os.pathsep) if name]


def use_files(names: Sequence[str | Path]) -> None:
    """Name further files as plug-ins, for this process and those that it starts.

    Raises:
        NotFoundError: there is no such file.
        UsageError: it is no Python file, or its path holds what separates paths.
    """
    paths = [Path(name).absolute() for name in names]
    for path in [*files(), *paths]:
        if not path.is_file():
            raise NotFoundError(f"{printable(str(path))}: no such file, named as a plug-in")
        if path.suffix != ".py" or not path.stem.isidentifier() or os.pathsep in str(path):
            raise UsageError(
                f"{printable(str(path))}: a plug-in's file is a Python module: letters, digits, _, then .py"
            )
    if known := dict.fromkeys([*(path.absolute() for path in files()), *paths]):
        os.environ[VARIABLE] = os.pathsep.join(map(str, known))


def use_only(names: Sequence[str | Path]) -> None:
    """Name just these files as plug-ins and import them, in a process that serves several programs in turn.

    Raises:
        NotFoundError, UsageError: as `use_files`.
        PluginError: one of them can't be imported.
    """
    os.environ.pop(VARIABLE, None)
    use_files(names)
    for file in files():
        sys.modules[_name(file)] = _module(file)


def versions_of(kinds: Iterable[type]) -> dict[str, str]:
    """What a run's folder keeps of the kinds of others: a package's version, of a file a part of its sha256."""
    modules = {kind.__module__ for kind in kinds if is_others(getattr(sys.modules[kind.__module__], "__file__", ""))}
    if not modules:  # who looks through all packages looks long
        return {}
    by_file = {_name(path): path for path in files()}
    found = {}
    for section in GROUPS:
        for source in declared(section):
            if source.entry is not None and source.entry.module in modules:
                found[source.package] = source.version
    for module in modules & set(by_file):
        content = by_file[module].read_bytes()
        found[f"plugin {by_file[module].name}"] = hashlib.sha256(content).hexdigest()[:16]
    return found


def declared(section: str) -> list[Source]:
    """Every kind that packages declare in a section of the config, `agents` or `humans`, none being imported."""
    found = [entry for entry in entry_points(group=GROUPS[section]) if entry.dist is None or entry.dist.name != OURS]
    return [
        Source(
            entry.name, entry.dist.name if entry.dist else entry.value, entry.dist.version if entry.dist else "", entry
        )
        for entry in sorted(found, key=lambda entry: entry.name)
    ]


def all_words(section: str, base: type[Base]) -> list[Source]:
    """Every kind of others, each word once for each who declares it; files are imported, packages are not.

    Those of a file that can't be imported are left out (`faults_of_files`).
    """
    found = []
    for file in files():
        with suppress(PluginError):
            found += [Source(word, str(file), "", None) for word, _ in _kinds_of(file, base)]
    return [*found, *declared(section)]


def in_files(base: type[Base]) -> Iterator[tuple[Source, type[Base]]]:
    """Every kind in the files that are named as plug-ins.

    Raises:
        PluginError: one of them can't be imported.
    """
    for file in files():
        for word, kind in _kinds_of(file, base):
            yield Source(word, str(file), "", None), kind


def _kinds_of(file: Path, base: type[Base]) -> Iterator[tuple[str, type[Base]]]:
    """Those of a file; a class without a word is what some share."""
    return (found for found in kinds_in(_module(file), base) if found[0] != UNSAID)


def faults_of_files(sections: Mapping[str, tuple[Container[str], type[BaseModel]]]) -> dict[Path, str]:
    """Why files that are named as plug-ins can't be used: not imported, without a kind, with a word of ours.

    Args:
        sections: the built-in words of each section, and what its kinds derive from.
    """
    return {file: fault for file in files() if (fault := _fault_of(file, sections))}


def _fault_of(file: Path, sections: Mapping[str, tuple[Container[str], type[BaseModel]]]) -> str:
    words = []
    for built_in, base in sections.values():
        try:
            found = [word for word, _ in _kinds_of(file, base)]
        except PluginError as error:
            return str(error)
        if taken := [word for word in found if word in built_in]:
            return f"{file}: {taken[0]} is a kind of {OURS}'s own; it needs another name"
        words += found
    bases = " or ".join(base.__name__ for _, base in sections.values())
    return "" if words else f"{file}: declares no kind: no class in it is a subclass of {bases} with kind: Literal[...]"


def find(section: str, word: str, base: type[Base]) -> type[Base]:
    """The kind of somebody else that a word of the config means.

    Raises:
        NoSuchKindError: nobody declares it.
        PluginError: two do, or the one that does can't be used.
    """
    candidates: dict[Source, object] = {source: kind for source, kind in in_files(base) if source.word == word}
    candidates |= {source: None for source in declared(section) if source.word == word}
    if not candidates:
        how = "install its package, or name its file by --plugin"
        raise NoSuchKindError(f"no kind of {section} is called {word} here; {how}")
    if len(candidates) > 1:
        both = " and ".join(sorted(map(str, candidates)))
        raise PluginError(f"{word} is declared by {both}; uninstall, or leave out, all but one")
    ((source, kind),) = candidates.items()
    return _checked(source, _imported(source) if kind is None else kind, base)


@contextmanager
def _kept_apart() -> Iterator[None]:
    """What is imported in the block prints to standard error, and leaves the current folder as it is."""
    here = None
    with suppress(OSError):  # it may have been removed
        here = Path.cwd()
    try:
        with to_stderr():
            yield
    finally:
        if here is not None:
            os.chdir(here)


def _imported(source: Source) -> object:
    assert source.entry is not None
    try:
        with _kept_apart():
            found: object = source.entry.load()
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        why = f"{type(error).__name__}: {error}".splitlines()[0]
        raise PluginError(
            f"{source.word}, of {source}, can't be imported: {why}; mend it or install another version"
        ) from error
    return found


def _checked(source: Source, kind: object, base: type[Base]) -> type[Base]:
    if not isinstance(kind, type) or not issubclass(kind, base) or source.word not in words_of(kind):
        needed = f"a subclass of {base.__name__} whose kind is Literal[{source.word!r}]"
        raise PluginError(f"{source.word}, of {source}, is not {needed}; its package must be mended")
    if (api := getattr(kind, "api", API)) != API:
        raise PluginError(
            f"{source.word}, of {source}, was written for API {api}; this visitlab has API {API}: "
            f"install another version of {source.package} or of visitlab"
        )
    return kind


def _name(file: Path) -> str:
    return f"visitlab_plugin_{file.stem}"


@cache
def _module(file: Path) -> ModuleType:
    name = _name(file)
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    is_others(str(file))
    sys.modules[name] = module
    try:
        with _kept_apart():
            spec.loader.exec_module(module)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        del sys.modules[name]
        why = f"{type(error).__name__}: {error}".splitlines()[0]
        raise PluginError(f"{file} can't be imported: {why}; mend it") from error
    return module
