"""Finding a config: a file, or by its bare name one that visitlab ships."""

import re
from pathlib import Path

from visitlab_cli.config.names import NAME_PATTERN
from visitlab_cli.errors import NotFoundError
from visitlab_cli.wording import nearest_name, printable
from visitlab_cli.yaml.files import unread

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
        UnreadableError: we may not look.
    """
    path = Path(name)
    try:
        exists, is_folder = path.exists(), path.is_dir()
    except (OSError, ValueError) as error:
        raise unread(printable(str(name)), error) from None
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
    folders = dict.fromkeys(f"{other.partition('/')[0]}/" for other in shipped if "/" in other)
    hint = f"; did you mean {near}?" if near else f"; shipped: {', '.join(main)} and those in {' and '.join(folders)}"
    raise NotFoundError(f"{printable(str(name))}: no such file, nor a shipped config{hint}")
