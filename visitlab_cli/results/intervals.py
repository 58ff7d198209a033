"""Student's t without tables: the incomplete beta function by its continued fraction, inverted by bisection.

Source: Abramowitz and Stegun, Handbook of Mathematical Functions, 26.5.8 and 26.7.1; Lentz's evaluation.
"""

import math
from collections.abc import Sequence
from functools import cache

import numpy as np

CONFIDENCE = 0.95
BISECTIONS = 60
MOST_TERMS, CLOSE = 1000, 1e-15


def _incomplete_beta(x: float, a: float, b: float) -> float:
    """The regularised incomplete beta function, by its continued fraction where that converges fast."""
    if x >= (a + 1) / (a + b + 2):
        return 1.0 - _incomplete_beta(1.0 - x, b, a)
    scale = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)) / a
    numerator, denominator = 1.0, 1.0 / (1.0 - (a + b) * x / (a + 1))
    fraction = denominator
    for m in range(1, MOST_TERMS):
        even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        for term in (even, odd):
            denominator = 1.0 / (1.0 + term * denominator)
            numerator = 1.0 + term / numerator
            factor = numerator * denominator
            fraction *= factor
        if abs(factor - 1.0) < CLOSE:
            break
    return scale * fraction


@cache
def t_quantile(degrees: float, confidence: float = CONFIDENCE) -> float:
    """The t that |T| stays below with probability `confidence`, for `degrees` of freedom, 1 or more."""
    low, high = 0.0, math.pi / 2
    for _ in range(BISECTIONS):
        middle = (low + high) / 2  # t = tan(middle) sqrt(degrees)
        if 1.0 - _incomplete_beta(math.cos(middle) ** 2, degrees / 2, 0.5) < confidence:
            low = middle
        else:
            high = middle
    return math.tan(low) * math.sqrt(degrees)


def deviation(values: Sequence[float]) -> float:
    """The standard deviation between `values` (ddof 1); nan for fewer than two."""
    return float(np.std(values, ddof=1)) if len(values) > 1 else math.nan
