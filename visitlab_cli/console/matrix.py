"""`visitlab eval --matrix`: play every trained human against every human; print the goals, draw them."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from visitlab_cli.console.running import How, raise_first, run_missing
from visitlab_cli.console.words import aligned
from visitlab_cli.errors import RunError, UsageError, VisitlabError
from visitlab_cli.terminal import tell, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.config.model import Config
    from visitlab_cli.results.matrix import Matrix, Planned


def check_options(*, matrix: bool, frozen: bool, picture: Path | None) -> None:
    """Refuse options that mean nothing together.

    Raises:
        UsageError: they do not go together, or the picture has no format.
    """
    from visitlab_cli.pictures.style import FORMATS

    if matrix and frozen:
        raise UsageError("--matrix plays both frozen and adapting; leave out --frozen")
    if picture is None:
        return
    if not matrix:
        raise UsageError("--picture draws a matrix; add --matrix")
    if picture.suffix[1:] not in FORMATS:
        raise UsageError(f"--picture {picture}: must end in {', '.join(f'.{kind}' for kind in FORMATS)}")


def planned_cells(run: Path, config: "Config", visit: str, humans: Sequence[str], trials: int | None) -> "Planned":
    """The visits of a run's matrix.

    Raises:
        UsageError: the config is a grid, of which each point would have a matrix.
    """
    from visitlab_cli.results.matrix import plan_matrix

    if config.vary:
        raise UsageError(f"--matrix: {run} is a grid (its config varies {', '.join(config.vary)}); run one point of it")
    return plan_matrix(config, visit, humans, trials)


def play_matrix(run: Path, planned: "Planned", picture: Path | None, how: How) -> None:
    """Play what is missing, print the matrix and draw it; with `dry_run` only tell what there is to do.

    Raises:
        RunError: a cell failed, or the picture can't be written.
        UsageError: quiet and verbose at once, or what lies in the picture's place is not visitlab's.
    """
    from visitlab_cli.figures.matrix_picture import save_matrix
    from visitlab_cli.origin import check_ours
    from visitlab_cli.results.matrix import matrix_of
    from visitlab_cli.storage.inside import check_inside

    target = picture or run / _own_picture(planned)
    if picture is None:
        check_inside(run, target)
    check_ours(target)
    failures = run_missing(run, [cell for each in planned.values() for cell in each], how)
    if failures is None:
        return
    matrix = matrix_of(run, planned)
    if how.as_json:
        tell_json({"run": str(run), **matrix.as_json(), "picture": str(target)})
    else:
        tell_text(text(matrix))
    try:
        before = _content(target)
        save_matrix(matrix, target)
        if before not in (None, _content(target)) and not how.quiet:
            tell(f"{target}: took the place of another matrix, of other humans, trials or seeds", err=True)
        if not how.as_json:
            tell("", str(target))
    except VisitlabError as error:
        if not failures:
            raise
        tell(*map(str, error.args), err=True)
    raise_first(failures)


def _own_picture(planned: "Planned") -> Path:
    """Where in a run the matrix of a visit is drawn: that of another visit than the config's first says of which."""
    from visitlab_cli.storage.on_disk import FIGURES

    some = next(iter(planned.values()))[0]
    first = next(name for name, each in some.config.experiments.items() if each.assembled)
    return Path(FIGURES, "matrix.svg" if some.experiment == first else f"matrix-{some.experiment}.svg")


def _content(picture: Path) -> bytes | None:
    """What is there; None where nothing is, or what can't be read."""
    from visitlab_cli.storage.reading import read_bytes

    try:
        return read_bytes(picture)
    except (OSError, ValueError, RunError):
        return None


def text(matrix: "Matrix") -> str:
    """A table for each mode: a row for each human trained with, a column for each that is led."""
    from visitlab_cli.results.matrix import ADAPTING, FROZEN

    trials = f"{matrix.trials:,} trial{'s' if matrix.trials != 1 else ''}"
    return "\n\n".join(
        [
            f"Goals a trial of {matrix.visit} with {matrix.social}, {matrix.n}.\n"
            "Mean over them ± half its 95% interval (Student's t).",
            *([matrix.rows] if matrix.rows else []),
            f"Frozen: nothing is learned or explored; all {trials}\n{_table(matrix, FROZEN)}",
            f"Adapting: the social module goes on learning; last tenth of {trials}\n{_table(matrix, ADAPTING)}",
        ]
    )


def _table(matrix: "Matrix", mode: str) -> str:
    from visitlab_cli.results.matrix import Pairing

    rows = [["trained with", *matrix.met]]
    for trained in matrix.trained:
        values = [matrix.goals[Pairing(trained, met, mode)].value for met in matrix.met]
        rows.append([trained, *(value.in_words() if value else "-" for value in values)])
    return aligned(rows, words=1)
