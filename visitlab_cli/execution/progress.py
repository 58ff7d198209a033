"""What the user sees while cells run: a bar on a terminal, a line of result each, everything on stderr."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import rich.progress
from rich.console import Console
from rich.text import Text

from visitlab_cli.execution.cells import Cell


class _Speed(rich.progress.ProgressColumn):
    def render(self, task: rich.progress.Task) -> Text:
        """Steps a second, over all workers."""
        speed = task.finished_speed or task.speed
        return Text(f"{speed:,.0f} steps/s" if speed else "", style="progress.data.speed")


class Progress:
    """One bar over the steps of all cells, and a line for each cell that ends."""

    def __init__(self, quiet: bool = False) -> None:
        """With `quiet` only failures are told."""
        self.console = Console(stderr=True, quiet=quiet, highlight=False, soft_wrap=True)
        self._bar = rich.progress.Progress(
            rich.progress.TextColumn("{task.description}"),
            rich.progress.BarColumn(),
            rich.progress.TaskProgressColumn(),
            _Speed(),
            rich.progress.TimeRemainingColumn(),
            console=self.console,
            transient=True,
            disable=quiet or not self.console.is_terminal,
        )
        self._task = rich.progress.TaskID(0)
        self._done: dict[str, int] = {}
        self._ended = 0
        self._cells = 0

    def say(self, line: str) -> None:
        """Tell the user something."""
        self.console.print(line, markup=False)

    @contextmanager
    def over(self, cells: Sequence[Cell]) -> Iterator[None]:
        """Show the bar while these cells run."""
        self._cells = len(cells)
        self._task = self._bar.add_task(self._description(), total=sum(cell.steps for cell in cells))
        with self._bar:
            yield

    def _description(self) -> str:
        return f"{self._ended}/{self._cells} cells"

    def update(self, cell: Cell, steps: int) -> None:
        """`cell` has done `steps` steps."""
        self._done[cell.path] = max(steps, self._done.get(cell.path, 0))
        self._bar.update(self._task, completed=sum(self._done.values()), description=self._description())

    def finished(self, cell: Cell, facts: dict[str, Any] | None) -> None:
        """`cell` is done: its line of result."""
        self._ended += 1
        self.update(cell, cell.steps)
        if facts is not None:
            reward = facts["mean_reward_last_hundredth"]
            self.say(f"{cell.path}: {reward:.2f} reward a trial in the last 1% of {facts['trials']:,} trials")

    def failed(self, cell: Cell, line: str) -> None:
        """`cell` failed."""
        self._ended += 1
        self.update(cell, cell.steps)
        self.say(f"{cell.path}: failed: {line}")
