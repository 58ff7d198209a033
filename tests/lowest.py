"""The lowest versions that `pyproject.toml` declares, as constraints for pip: `python -m tests.lowest > FILE`.

Only what is named there is held down; what those packages need in turn is the newest that they allow. A bound that
pip can't join with the others (numpy's with numba's, say) ends the installation, which says which.
"""

import re
import tomllib
from pathlib import Path

PROJECT = Path(__file__).parents[1] / "pyproject.toml"
BOUND = re.compile(r"(?P<name>[A-Za-z0-9_.-]+)(\[[^]]*\])?\s*>=\s*(?P<lowest>[0-9.]+)")


def lowest() -> list[str]:
    """A line `name==version` for every dependency, extras included, that has a lower bound."""
    project = tomllib.loads(PROJECT.read_text())["project"]
    declared = [
        *project["dependencies"],
        *(each for extra in project["optional-dependencies"].values() for each in extra),
    ]
    found = {bound["name"]: bound["lowest"] for each in declared if (bound := BOUND.match(each))}
    return [f"{name}=={version}" for name, version in sorted(found.items())]


if __name__ == "__main__":
    print("\n".join(lowest()))
