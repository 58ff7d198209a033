"""In which order cells start: each once those that it needs are done, and visits before trainings."""

import heapq
from collections.abc import Sequence

from visitlab_cli.plan.cells import Cell


class Order:
    """The cells that are yet to start. A visit whose modules are there comes before trainings, whosever they are."""

    def __init__(self, cells: Sequence[Cell]) -> None:
        """All of `cells`; what they need and is not among them is there, or nobody makes it."""
        self._cells = list(cells)
        paths = {cell.path for cell in cells}
        self._lacking = {cell.path: set(cell.modules.values()) & paths for cell in cells}
        self._needing: dict[str, list[int]] = {}
        self._ready: list[tuple[bool, bool, int]] = []
        for number, cell in enumerate(cells):
            for path in self._lacking[cell.path]:
                self._needing.setdefault(path, []).append(number)
            if not self._lacking[cell.path]:
                self._is_ready(number)

    def __bool__(self) -> bool:
        return bool(self._lacking)

    def next(self) -> Cell | None:
        """Take the cell that is to start next; None while all wait for others."""
        if not self._ready:
            return None
        cell = self._cells[heapq.heappop(self._ready)[-1]]
        del self._lacking[cell.path]
        return cell

    def done(self, path: str) -> None:
        """A cell is there."""
        for number in self._needing.pop(path, []):
            lacking = self._lacking.get(self._cells[number].path)
            if lacking is not None:
                lacking.discard(path)
                if not lacking:
                    self._is_ready(number)

    def failed(self, path: str) -> list[Cell]:
        """A cell will not be there: take those that need it."""
        needing = [self._cells[number] for number in self._needing.pop(path, [])]
        return [cell for cell in needing if self._lacking.pop(cell.path, None) is not None]

    def clear(self) -> None:
        """Nothing is to start any more."""
        self._lacking, self._ready = {}, []

    def _is_ready(self, number: int) -> None:
        cell = self._cells[number]
        heapq.heappush(self._ready, (not cell.settings.assembled, not cell.modules, number))
