"""What a user should know of a plan before it runs: what the config says and nothing comes of."""

from collections.abc import Iterator, Sequence

from visitlab_cli.plan.cells import Cell
from visitlab_cli.settings import as_yaml
from visitlab_cli.wording import shown
from visitlab_cli.world.tasks import SOCIAL


def notes_on(cells: Sequence[Cell]) -> list[str]:
    """A line for each setting without an effect, but for what a config refuses; each once."""
    visits = {(id(cell.config), cell.experiment, cell.human): cell for cell in cells if cell.settings.assembled}
    return list(dict.fromkeys(line for cell in visits.values() if not cell.frozen for line in _notes(cell)))


def _notes(cell: Cell) -> Iterator[str]:
    settings, path = cell.settings, f"experiments.{cell.experiment}"
    starts = [settings.starts[role] for role in settings.pooled] or [settings.starts[SOCIAL]]
    own = as_yaml(cell.learner)
    for name in dict.fromkeys(start.agent for start in starts[1:]):
        other = as_yaml(settings.parameters_of(cell.config.agents[name]))
        differing = [key for key in own if other[key] != own[key]]
        if differing:
            dropped, held = (", ".join(f"{key} {shown(each[key])}" for key in differing) for each in (other, own))
            yield f"{path}: the pool goes on as its first agent, {cell.agent} ({held}); {name}'s {dropped} is dropped"
    if cell.human not in {start.human for start in starts} and not settings.phases and cell.learner.is_told:
        yield (
            f"{path}: agents.{cell.agent}.told: there are no phases, so nobody is told; with {cell.human} it goes on "
            f"with what it learned with {' and '.join(str(start.human) for start in starts)}"
        )
