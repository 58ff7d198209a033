"""Student's t without tables: the finite sums for whole degrees of freedom, inverted by bisection.

Source: Abramowitz and Stegun, Handbook of Mathematical Functions, 26.7.3 and 26.7.4.
"""

import math
from collections.abc import Sequence
from functools import cache

import numpy as np

CONFIDENCE = 0.95
BISECTIONS = 60


def _within(angle: float, degrees: int) -> float:
    """P(|T| < t) for `degrees` of freedom, with t = tan(angle) sqrt(degrees), angle in (0, pi/2)."""
    cosine, sine = math.cos(angle), math.sin(angle)
    odd = degrees % 2 == 1
    if degrees == 1:
        return 2 * angle / math.pi
    k = np.arange(1, degrees // 2)
    ratios = 2 * k / (2 * k + 1) if odd else (2 * k - 1) / (2 * k)
    total = 1 + float(np.cumprod(ratios * cosine**2).sum())
    return 2 / math.pi * (angle + sine * cosine * total) if odd else sine * total


@cache
def t_quantile(degrees: int, confidence: float = CONFIDENCE) -> float:
    """The t that |T| stays below with probability `confidence`, for `degrees` of freedom, at least 1."""
    low, high = 0.0, math.pi / 2
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if _within(middle, degrees) < confidence:
            low = middle
        else:
            high = middle
    return math.tan(low) * math.sqrt(degrees)


def deviation(values: Sequence[float]) -> float:
    """The standard deviation between `values` (ddof 1); nan for fewer than two."""
    return float(np.std(values, ddof=1)) if len(values) > 1 else math.nan
