"""The table of faults in `docs/reliability.md`, between two marks."""

import os
import platform
import re
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "reliability.md"
BLOCK = re.compile(r"(<!-- faults: begin -->\n).*(<!-- faults: end -->)", re.DOTALL)


def write_page(rows: Sequence[tuple[str, str, int, int, int, str]], command: str, times: str) -> None:
    """Write what was tried and came of it, with the day, the command and the machine."""
    lines = ["| class | fault | tries | lost | wrong |", "|---|---|---:|---:|---:|"]
    for name, about, tries, lost, wrong, not_tried in rows:
        what = f"{about} (not tried: {not_tried})" if not_tried else about
        lines.append(f"| {name} | {what} | {tries:,} | {lost} | {wrong} |")
    tries = sum(each[2] for each in rows)
    day = datetime.now(UTC).date().isoformat()
    machine = f"Python {platform.python_version()} on {platform.system()}, {os.cpu_count()} cores"
    told = f"`{command}`, {day}, {machine}: {tries:,} tries in {times}."
    text = PAGE.read_text()
    PAGE.write_text(BLOCK.sub(lambda marks: f"{marks[1]}{told}\n\n" + "\n".join(lines) + f"\n{marks[2]}", text))
