"""Make the output in docs/tutorial.md anew: `python -m tests.docs.make_tutorial`; two minutes."""

import tempfile
from pathlib import Path

from tests.docs.tutorial import PAGE, made_anew


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        PAGE.write_text(made_anew(PAGE.read_text(), Path(folder)))


if __name__ == "__main__":
    main()
