"""Packages as if they were installed: their modules and what they declare in a folder that is on Python's path."""

import tomllib
from pathlib import Path

EXAMPLES = Path(__file__).parents[1] / "examples"


def installed(project: Path, place: Path) -> dict[str, str]:
    """Install a project into the folder `place`, editable, without the network; what to add to the environment."""
    about = tomllib.loads((project / "pyproject.toml").read_text())
    name, version = about["project"]["name"], about["project"]["version"]
    for package in about["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]:
        (place / package).symlink_to(project / package)
    info = place / f"{name.replace('-', '_')}-{version}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    entries = [
        f"[{group}]\n" + "".join(f"{word} = {value}\n" for word, value in words.items())
        for group, words in about["project"]["entry-points"].items()
    ]
    (info / "entry_points.txt").write_text("\n".join(entries))
    return {"PYTHONPATH": str(place)}
