"""Finding a config: a file, or by its bare name one that visitlab ships."""

import re
from pathlib import Path

from visitlab_cli.config.document import Node, Place
from visitlab_cli.config.names import NAME_PATTERN
from visitlab_cli.config.problems import Problem, failure, nearest_name, printable
from visitlab_cli.config.yaml_reader import read_yaml
from visitlab_cli.errors import NotFoundError

MOST_BYTES = 1 << 20

_PACKAGE = Path(__file__).parent.parent


def shipped_folder() -> Path:
    """Where the shipped configs lie: in the wheel, or in a checkout."""
    in_wheel = _PACKAGE / "shipped_configs"
    return in_wheel if in_wheel.is_dir() else _PACKAGE.parent / "configs"


def shipped_configs() -> dict[str, Path]:
    """The shipped configs by name, such as `quickstart` or `paper/fig7`; parts of others, which have none, aside."""
    folder = shipped_folder()
    found = {file.relative_to(folder).with_suffix("").as_posix(): file for file in sorted(folder.rglob("*.yaml"))}
    return {name: file for name, file in found.items() if re.search(r"^name:", file.read_text("utf-8"), re.MULTILINE)}


def find(name: str | Path) -> Path:
    """The file meant by a path or by the bare name of a shipped config.

    Raises:
        NotFoundError: if there is neither; it says what is shipped.
    """
    path = Path(name)
    try:
        exists, is_folder = path.exists(), path.is_dir()
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = getattr(error, "strerror", None) or str(error)
        raise NotFoundError(f"{printable(str(name))}: {reason}") from None
    if exists and not is_folder:
        return path
    shipped = shipped_configs()
    if not str(name):
        raise NotFoundError("no config is called ''")
    if str(name) in shipped:
        return shipped[str(name)]
    if is_folder:
        raise NotFoundError(f"{printable(str(name))}: a folder, not a config")
    if any(not re.fullmatch(NAME_PATTERN.removesuffix("$"), part) for part in str(name).split("/")):
        raise NotFoundError(f"{printable(str(name))}: no such file")
    near = nearest_name(str(path.with_suffix("")), shipped)
    main = [other for other in shipped if "/" not in other]
    hint = f"; did you mean {near}?" if near else f"; shipped: {', '.join(main)} and parts of paper/"
    raise NotFoundError(f"{printable(str(name))}: no such file, nor a shipped config{hint}")


def read_file(path: Path) -> tuple[Node, list[Problem]]:
    """The mapping in a YAML file, and what was wrong with its keys.

    Raises:
        NotFoundError: if it cannot be opened.
        ConfigError: if it is too large, not UTF-8, not YAML or not a mapping.
    """
    shown = printable(str(path))
    try:
        with path.open("rb") as file:
            content = file.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise NotFoundError(f"{shown}: {reason[:1].lower()}{reason[1:]}") from None
    if len(content) > MOST_BYTES:
        raise failure([Problem(Place(shown), (), f"larger than {MOST_BYTES >> 20} MiB; no config is")])
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        column = error.start - content.rfind(b"\n", 0, error.start)
        raise failure([Problem(Place(shown, line, column), (), "not UTF-8")]) from None
    node, problems = read_yaml(text, shown)
    if node is None:
        message = "empty; `visitlab init` writes a config to start from"
        raise failure([Problem(Place(shown, 1, 1), (), message)])
    if not isinstance(node.value, dict):
        kind = "a list" if isinstance(node.value, list) else "one value"
        raise failure([*problems, Problem(node.place, (), f"must be a mapping (got {kind})")])
    return node, problems
