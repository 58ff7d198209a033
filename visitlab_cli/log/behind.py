"""Work done in a thread of its own, one piece behind whoever hands it over: writing a log, while the next is played."""

import threading
from collections.abc import Callable
from queue import SimpleQueue

Piece = Callable[[], None]


class Behind:
    """Does what it is handed, in order, one piece at a time; what a piece raises comes out of the next call."""

    def __init__(self) -> None:
        """The thread starts with the first piece."""
        self._thread: threading.Thread | None = None
        self._pieces: SimpleQueue[Piece | None] = SimpleQueue()
        self._results: SimpleQueue[BaseException | None] = SimpleQueue()
        self._under_way = False

    @property
    def has_begun(self) -> bool:
        """Whether the thread was started."""
        return self._thread is not None

    def hand(self, piece: Piece) -> None:
        """Have a piece done, as soon as the one before is; at once, where no thread can be had."""
        self.wait()
        if self._thread is None:
            thread = threading.Thread(target=self._work, name="visitlab-behind", daemon=True)
            try:
                thread.start()
            except RuntimeError:  # the system allows no more
                piece()
                return
            self._thread = thread
        self._pieces.put(piece)
        self._under_way = True

    def wait(self) -> None:
        """Return when everything is done, or raise what was raised."""
        if self._under_way:
            error = self._results.get()
            self._under_way = False
            if error is not None:
                try:
                    raise error
                finally:
                    del error  # whose traceback holds this frame

    def end(self) -> None:
        """End the thread, once everything is done; what was raised is still told by `wait`."""
        if self._thread is not None:
            self._pieces.put(None)
            self._thread.join()
            self._thread = None

    def _work(self) -> None:
        while (piece := self._pieces.get()) is not None:
            try:
                piece()
            except BaseException as error:
                self._results.put(error)
            else:
                self._results.put(None)
            del piece  # what it holds is not kept while waiting
