"""What the user sees while cells run: bars on a terminal, lines elsewhere; everything on stderr."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import rich.progress
from rich.console import Console
from rich.text import Text

from visitlab_cli.plan.cells import Cell
from visitlab_cli.terminal import plain

SECONDS_BETWEEN_LINES = 30.0
"""How often a line says how far everything is where there is no terminal to draw bars on."""


class _Speed(rich.progress.ProgressColumn):
    def render(self, task: rich.progress.Task) -> Text:
        """Steps a second."""
        speed = task.finished_speed or task.speed
        return Text(f"{speed:,.0f} steps/s" if speed else "", style="progress.data.speed")


class Progress:
    """A bar over the steps of all cells and, where several run at once, one for each; a line for each that ends."""

    def __init__(
        self,
        quiet: bool = False,
        verbose: bool = False,
        console: Console | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """With `quiet` only failures are told; `verbose` tells when each cell begins, and its speed."""
        self.quiet, self.verbose, self._clock = quiet, verbose, clock
        self.console = console or Console(stderr=True, highlight=False, emoji=False, soft_wrap=True)
        on_terminal = self.console.file.isatty() and self.console.is_terminal  # not by FORCE_COLOR alone
        self._bars = rich.progress.Progress(
            rich.progress.TextColumn("{task.description}", markup=False),
            rich.progress.BarColumn(),
            rich.progress.TaskProgressColumn(),
            _Speed(),
            rich.progress.TimeRemainingColumn(),
            console=self.console,
            transient=True,
            disable=quiet or not on_terminal,
        )
        self._total = rich.progress.TaskID(0)
        self._steps = 0
        self._bar_of: dict[str, rich.progress.TaskID] = {}
        self._begun: dict[str, float] = {}
        self._done: dict[str, int] = {}
        self._done_before: dict[str, int] = {}
        self._ended = 0
        self._cells = 0
        self._started = self._last_line = clock()

    def say(self, line: str, style: str | None = None) -> None:
        """Tell the user something, unless only failures are to be told."""
        if not self.quiet:
            self.console.print(plain(line), style=style, markup=False)

    def warn(self, line: str) -> None:
        """Tell the user something that is to be told in any case."""
        self.console.print(plain(line), style="yellow", markup=False)

    @contextmanager
    def over(self, cells: Sequence[Cell]) -> Iterator[None]:
        """Show the bars while these cells run."""
        self._cells = len(cells)
        self._steps = sum(cell.steps for cell in cells)
        self._started = self._last_line = self._clock()
        self._total = self._bars.add_task(self._description(), total=self._steps)
        with self._bars:
            yield

    def _description(self) -> str:
        return f"{self._ended}/{self._cells} cells"

    def update(self, cell: Cell, steps: int) -> None:
        """`cell` has done `steps` steps."""
        if cell.path not in self._begun:
            self._begun[cell.path] = self._clock()
            if self._cells > 1:
                self._bar_of[cell.path] = self._bars.add_task(cell.path, total=cell.steps)
            if self.verbose:
                self.say(f"{cell.path}: begins, {cell.steps:,} steps")
        self._done[cell.path] = max(steps, self._done.get(cell.path, 0))
        if cell.path in self._bar_of:
            self._bars.update(self._bar_of[cell.path], completed=self._done[cell.path])
        self._bars.update(self._total, completed=sum(self._done.values()), description=self._description())
        if self._bars.disable and self._clock() - self._last_line >= SECONDS_BETWEEN_LINES:
            self._tell_how_far()

    def goes_on(self, cell: Cell, steps: int) -> None:
        """`cell` is gone on with from a step, by a checkpoint; told once."""
        if self._done_before.get(cell.path) != steps:
            self._done_before[cell.path] = steps
            self.say(f"{cell.path}: goes on from step {steps:,} of {cell.steps:,}")

    def _tell_how_far(self) -> None:
        self._last_line = self._clock()
        done = sum(self._done.values())
        speed = (done - sum(self._done_before.values())) / max(self._last_line - self._started, 1e-9)
        left = f", about {(self._steps - done) / speed:,.0f} s left" if speed else ""
        self.say(f"{self._description()}, {done / self._steps:.0%} of the steps, {speed:,.0f} steps/s{left}")

    def _end(self, cell: Cell) -> None:
        self.update(cell, cell.steps)
        self.done_elsewhere(cell)

    def finished(self, cell: Cell, facts: dict[str, Any] | None) -> None:
        """`cell` is done: its line of result."""
        self._end(cell)
        if facts is not None:
            reward = facts["mean_reward_last_hundredth"]
            seconds = self._clock() - self._begun[cell.path]
            speed = f"; {seconds:.1f} s, {cell.steps / max(seconds, 1e-9):,.0f} steps/s" if self.verbose else ""
            self.say(f"{cell.path}: {reward:.2f} reward a trial in the last 1% of {facts['trials']:,} trials{speed}")

    def done_elsewhere(self, cell: Cell) -> None:
        """Another runner has done `cell`."""
        self._ended += 1
        self._done[cell.path] = cell.steps
        if cell.path in self._bar_of:
            self._bars.remove_task(self._bar_of.pop(cell.path))
        self._bars.update(self._total, completed=sum(self._done.values()), description=self._description())

    def failed(self, cell: Cell, line: str) -> None:
        """`cell` failed; this is told in any case."""
        self._end(cell)
        self.console.print(plain(f"{cell.path}: failed: {line}"), style="red", markup=False)
