"""All that is measured, as one table: playing, recording, reading, the program, how cost grows, what limits it.

    python -m benchmarks [--only MODULE] [--page docs/performance.md]

Some twenty minutes of two quiet cores. What is compared is measured side by side in this run; quote the ratios.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from benchmarks.rows import Row, markdown, show

TITLES = {
    "simulation": "Playing and recording",
    "limits": "What the machine could do at most",
    "labs": "Walls, doors and plans to lead",
    "environments": "Gymnasium",
    "recording": "Recording",
    "reading": "Reading",
    "plugins": "Agents from outside",
    "program": "The program as a whole",
    "slopes": "How cost grows",
}
TEMPLATE = Path(__file__).parent / "performance.template.md"


def machine() -> str:
    """What it was measured on, as far as it matters."""
    import numba

    model = platform.processor() or platform.machine()
    for line in Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else ():
        if line.startswith("model name"):
            model = line.partition(":")[2].strip()
    return f"{os.cpu_count()} cores of {model}, Python {platform.python_version()}, numba {numba.__version__}"


def in_new_process(name: str) -> Iterator[Row]:
    """The rows of a module, each as it comes; memory is told of what runs below a process of its own."""
    program = f"import json\nfrom benchmarks.{name} import rows\nfor row in rows(): print(json.dumps(row), flush=True)"
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout or ():
            yield Row(*json.loads(line))
    if process.returncode:
        sys.exit(f"benchmarks.{name} failed")


def main() -> None:
    """Measure, print, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", action="append", choices=TITLES, help="what is measured; may be repeated")
    parser.add_argument("--page", type=Path, metavar="FILE", help="write it as Markdown, too")
    asked = parser.parse_args()
    page = [TEMPLATE.read_text().replace("MACHINE", machine())]
    for name in asked.only or TITLES:
        print(f"\n{TITLES[name]} (python -m benchmarks.{name})")
        rows = show(in_new_process(name))
        page.append(f"## {TITLES[name]}\n\n`python -m benchmarks.{name}`\n\n{markdown(rows)}")
    if asked.page:
        asked.page.write_text("\n".join(page))


if __name__ == "__main__":
    main()
