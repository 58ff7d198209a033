"""Make the pages that are generated anew: `python -m tests.docs.make`; the tests check that they are current."""

import tempfile
from pathlib import Path

from tests.docs.cluster_page import cluster_page
from tests.docs.commands_page import commands_page
from tests.docs.config_page import config_page
from tests.docs.log_page import log_page
from visitlab_cli.config.schema import schema_text

ROOT = Path(__file__).parents[2]


def pages(folder: Path) -> dict[str, str]:
    """What each generated file should hold, by its path in the repository; `folder` is for trying things."""
    return {
        "docs/cluster.md": cluster_page(folder),
        "docs/commands.md": commands_page(),
        "docs/config.md": config_page(folder),
        "docs/log.md": log_page(),
        "configs/schema.json": schema_text(),
    }


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        for path, text in pages(Path(folder)).items():
            (ROOT / path).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
