"""Count events against the probabilities that they had, and tell how far off they are."""

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping
from statistics import NormalDist
from typing import Any, NamedTuple

FEW = 400.0  # below this variance the tail of the binomial is summed, above it is the normal's
Z_LIMIT = 37.0  # the normal's quantile of the smallest double


class Frequency(NamedTuple):
    """How often an event happened; z is positive where it happened too often."""

    name: str
    observed: int
    expected: float
    n: int
    z: float


class Tally:
    """Counts of events, each with the probabilities that it had."""

    def __init__(self) -> None:
        self._tried: dict[str, dict[float, int]] = defaultdict(lambda: defaultdict(int))
        self._happened: dict[str, int] = defaultdict(int)

    def add(self, name: str, happened: bool, probability: float) -> None:
        self._tried[name][probability] += 1
        if happened:
            self._happened[name] += 1

    def choice(self, name: str, got: Any, distribution: Mapping[Any, float]) -> None:
        """One event for each outcome of a draw that has at least two."""
        if len(distribution) > 1:
            for outcome, probability in distribution.items():
                self.add(f"{name}: {outcome}", got == outcome, probability)

    def uniform(self, name: str, got: Any, outcomes: Iterable[Any]) -> None:
        outcomes = list(outcomes)
        self.choice(name, got, {outcome: 1 / len(outcomes) for outcome in outcomes})

    def results(self) -> list[Frequency]:
        rows = []
        for name, tried in self._tried.items():
            n = sum(tried.values())
            expected = math.fsum(p * count for p, count in tried.items())
            variance = math.fsum(p * (1 - p) * count for p, count in tried.items())
            observed = self._happened[name]
            rows.append(Frequency(name, observed, expected, n, z_score(observed, expected, variance, n)))
        return rows


def z_score(observed: int, expected: float, variance: float, n: int) -> float:
    """Deviations from the mean; for rare events the normal quantile of the binomial's tail.

    Where the probabilities differ from try to try, the binomial of their mean is the wider one.
    """
    if variance <= 1e-12:
        return 0.0 if abs(observed - expected) < 1e-6 else math.copysign(math.inf, observed - expected)
    if variance >= FEW:
        return (observed - expected) / math.sqrt(variance)
    upward = observed > expected
    tail = min(_binomial_tail(n, expected / n, observed, upward), 0.5)
    z = -NormalDist().inv_cdf(tail) if tail > 1e-300 else Z_LIMIT
    return z if upward else -z


def _binomial_tail(n: int, p: float, k: int, upward: bool) -> float:
    """P(X >= k) or P(X <= k), summed from k outwards, for k on that side of the mean."""
    log_term = math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)
    log_term += k * math.log(p) + (n - k) * math.log1p(-p)
    term, total = math.exp(log_term), 0.0
    while term > total * 1e-15:
        total += term
        if upward:
            term *= (n - k) / (k + 1) * p / (1 - p)
            k += 1
        else:
            term *= k / (n - k + 1) * (1 - p) / p
            k -= 1
    return total
