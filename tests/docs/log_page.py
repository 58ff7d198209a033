"""docs/log.md: the log's fields and their meanings, from the one table that the writer works by."""

from pathlib import Path

from visitlab_cli.log.schema import TRIAL_COLUMNS, proto_text, tasks_in_words
from visitlab_cli.world.columns import COLUMNS

TEMPLATE = Path(__file__).with_name("log.template.md").read_text(encoding="utf-8")


def log_page() -> str:
    """The page."""
    enums = {column.enum.__name__: column.enum for column in COLUMNS if column.enum}
    return TEMPLATE.format(
        steps=fields(COLUMNS),
        trials=fields(TRIAL_COLUMNS),
        enums="\n".join(values(name, enum) for name, enum in enums.items()),
        proto=proto_text(),
    )


def fields(columns):
    lines = ["| field | type | tasks | meaning |", "|---|---|---|---|"]
    for column in columns:
        kind = column.enum.__name__ if column.enum else column.kind
        tasks = tasks_in_words(column)
        lines.append(f"| `{column.name}` | {kind} | {tasks} | {column.meaning} |")
    return "\n".join(lines) + "\n"


def values(name, enum):
    return f"- **{name}**: " + ", ".join(f"{value.value} `{value.name}`" for value in enum) + "."
