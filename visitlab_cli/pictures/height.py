"""How high a panel of curves must be."""

from collections.abc import Sequence

from visitlab_cli.results.curves import Curve

ABOVE = 1.02
"""How far a panel reaches above the highest shade."""


def top_of(curves: Sequence[Curve], room: float) -> float:
    """Where a panel ends above: `room` times the highest mean, or higher, so that no interval's shade is cut off."""
    return max(max(room * float(curve.mean.max()), ABOVE * curve.highest) for curve in curves) or 1.0
