"""All ways in which a kernel's draws can fall, each with its exact probability.

The kernel's own text is run, uncompiled, with numbers in place of random ones that are decided only where they are
asked: `u < p` goes both ways, `int(u n)` all n. So no distribution is written a second time.
"""

from collections.abc import Callable
from types import FunctionType
from typing import Any

from visitlab_cli import random_numbers
from visitlab_cli.compiled import operations
from visitlab_cli.sources import PACKAGE

_DRAWS: dict[Any, Any] = {random_numbers.random_unit: lambda ways: ways.number()}


class Number:
    """Uniform in [low, high), within [0, 1): as much of it as was asked until now; `scale` times as large."""

    def __init__(self, ways: "Ways", scale: int = 1) -> None:
        """A number in [0, scale)."""
        self._ways, self._scale, self._low, self._high = ways, scale, 0.0, 1.0

    def __lt__(self, bound: float) -> bool:
        """Whether it is below a bound, if it lies on one side of it always; else one answer after the other."""
        inside = min(max(bound / self._scale, self._low), self._high)
        below = (inside - self._low) / (self._high - self._low)
        answer = self._ways.next((below, 1 - below)) == 0
        self._low, self._high = (self._low, inside) if answer else (inside, self._high)
        return answer

    def __mul__(self, scale: int) -> "Number":
        """Another one so many times as large."""
        return Number(self._ways, self._scale * scale)

    def __int__(self) -> int:
        """The whole part: each one in turn."""
        return self._ways.next((1 / self._scale,) * self._scale)


class Ways:
    """A random source that goes each way in turn, as an odometer: stands where a kernel takes its random state."""

    def __init__(self) -> None:
        """At the first of all ways."""
        self._chosen: list[tuple[int, tuple[float, ...]]] = []
        self._place, self.probability = 0, 1.0

    def number(self) -> Number:
        """The next draw."""
        return Number(self)

    def next(self, probabilities: tuple[float, ...]) -> int:
        """The choice at this place; the first time the first that can be."""
        if self._place == len(self._chosen):
            self._chosen.append((_possible(probabilities, 0), probabilities))
        choice, _ = self._chosen[self._place]
        self._place += 1
        self.probability *= probabilities[choice]
        return choice

    def turn(self) -> bool:
        """Go on to the next way; False where there is none."""
        self._place, self.probability = 0, 1.0
        while self._chosen:
            choice, probabilities = self._chosen.pop()
            following = _possible(probabilities, choice + 1)
            if following < len(probabilities):
                self._chosen.append((following, probabilities))
                return True
        return False


def _possible(probabilities: tuple[float, ...], first: int) -> int:
    """The first choice from `first` on that can be; their number if there is none."""
    return next((i for i in range(first, len(probabilities)) if probabilities[i] > 0), len(probabilities))


def outcomes(kernel: Callable[..., Any], *arguments: Any) -> dict[Any, float]:
    """What a kernel, whose last argument is a random state, may give, with the probabilities.

    Args:
        kernel: or the function of an operation for a record.
        *arguments: all but the last.
    """
    function, ways = undecided(kernel), Ways()
    found: dict[Any, float] = {}
    going = True
    while going:
        result = function(*arguments, ways)
        found[result] = found.get(result, 0.0) + ways.probability
        going = ways.turn()
    return found


_copies: dict[Any, Any] = {}


def undecided(kernel: Any) -> Any:
    """The same text, which takes `Ways` where the kernel takes a random state; and so do all that it calls.

    What is no kernel, or no function of this package, stays as it is.
    """
    if kernel in _DRAWS:
        return _DRAWS[kernel]
    if kernel in operations:
        operation = operations[kernel]
        return lambda record, *others: undecided(operation.plain(type(record)))(record, *others)
    plain = getattr(kernel, "py_func", kernel)
    if not isinstance(plain, FunctionType) or plain.__globals__.get("__package__", "").split(".")[0] != PACKAGE.name:
        return kernel
    if plain not in _copies:
        scope = dict(plain.__globals__)
        _copies[plain] = FunctionType(plain.__code__, scope, plain.__name__, plain.__defaults__, plain.__closure__)
        for name in plain.__code__.co_names:
            if callable(used := scope.get(name)) and not isinstance(used, type):
                scope[name] = undecided(used)
    return _copies[plain]
