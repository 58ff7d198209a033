"""One-line mutations of the package that the oracle must notice, and how one is applied to a copy."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Mutation:
    """One wrong line: `old`, which occurs exactly once in `file`, becomes `new`.

    `file` is relative to the package's folder; `task` is the task whose log must then be refused.
    """

    name: str
    file: str
    old: str
    new: str
    task: str


MUTATIONS: list[Mutation] = []


def apply(mutation: Mutation, package_copy_dir: Path) -> None:
    """Change one line of a copy of the package; `package_copy_dir` is the folder visitlab_cli of the copy."""
    file = package_copy_dir / mutation.file
    text = file.read_text(encoding="utf-8")
    count = text.count(mutation.old)
    assert count == 1, f"{mutation.name}: {mutation.old!r} occurs {count} times in {mutation.file}, not once"
    file.write_text(text.replace(mutation.old, mutation.new), encoding="utf-8")
