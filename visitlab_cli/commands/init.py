"""`visitlab init`: a commented config to start from, with everything that it includes, and the schema for editors."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import Json
from visitlab_cli.terminal import tell, tell_json

HELP = Help(
    "Configure",
    place=1,
    examples=(
        "visitlab init",
        "visitlab init my-human --folder experiments",
    ),
)


def command(
    name: Annotated[
        str,
        typer.Argument(
            help="Which one: quickstart, my-human, paper or another shipped config.",
            show_default=True,
            autocompletion=completion.shipped,
        ),
    ] = "quickstart",
    folder: Annotated[Path, typer.Option("--folder", "-f", help="Where to write it.", show_default="here")] = Path(),
    force: Annotated[bool, typer.Option("--force", help="Overwrite files of the same name.")] = False,
    as_json: Json = False,
) -> None:
    """Write a commented example config, what it includes, and the schema that editors use."""
    from visitlab_cli.config.files import shipped_configs, shipped_folder
    from visitlab_cli.config.schema import schema_text
    from visitlab_cli.errors import NotFoundError
    from visitlab_cli.wording import or_else

    shipped = shipped_configs()
    if name not in shipped:
        raise NotFoundError(f"{name}: no such example{or_else(name, list(shipped))}")
    origin = shipped_folder().resolve()
    files = {path.relative_to(origin): path.read_text(encoding="utf-8") for path in _with_includes(shipped[name])}
    files[Path("schema.json")] = schema_text()
    written = _write(folder, files, force)
    config = folder / f"{name}.yaml"
    if as_json:
        tell_json({"config": str(config), "files": [str(file) for file in written]})
    else:
        tell(*map(str, written))
        tell(f"next: visitlab run {config}", err=True)


def _with_includes(path: Path) -> Iterator[Path]:
    """A shipped config, and after it each file that it includes, once."""
    from visitlab_cli.yaml.files import read_file
    from visitlab_cli.yaml.include import INCLUDE

    waiting, seen = [path.resolve()], set[Path]()
    while waiting:
        file = waiting.pop(0)
        if file in seen:
            continue
        seen.add(file)
        yield file
        included = read_file(file)[0].entries().get(INCLUDE)
        waiting += [(file.parent / name).resolve() for name in (included.plain() if included else ())]


def _write(folder: Path, files: dict[Path, str], force: bool) -> list[Path]:
    """Write the files below `folder`, none if one of them is there with another content."""
    from visitlab_cli.errors import RunError, reason

    try:
        for name, text in files.items():
            target = folder / name
            if target.exists() and not target.is_file():
                raise RunError(f"{target}: is no file, so nothing is written to it; --folder writes elsewhere")
            if not force and target.exists() and target.read_bytes() != text.encode():
                raise RunError(
                    f"{target}: is there already, with another content; --force overwrites it, "
                    "--folder writes elsewhere"
                )
        for name, text in files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
    except OSError as error:
        raise RunError(f"{folder}: can't be written: {reason(error)}") from error
    return [folder / name for name in files]
