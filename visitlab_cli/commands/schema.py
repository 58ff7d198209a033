"""`visitlab schema`: the JSON Schema of a config, from which editors complete and check it."""

from visitlab_cli.console.help import Help
from visitlab_cli.terminal import tell_text

HELP = Help(
    "Configure",
    place=3,
    examples=(
        "visitlab schema | head",
        "visitlab schema > schema.json",
    ),
)


def command() -> None:
    """Print the JSON Schema of a config file, for editors.

    A config that begins with `# yaml-language-server: $schema=schema.json` is completed and checked while it is
    written, by every editor that has the YAML language server and finds the schema there.
    """
    from visitlab_cli.config.schema import schema_text

    tell_text(schema_text().rstrip("\n"))
