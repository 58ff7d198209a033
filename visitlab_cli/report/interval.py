"""The picture of a mean and its interval in a table: a dot and a bar on a line, and the same in words."""

import math
from collections.abc import Iterable

from visitlab_cli.report.markup import Html, element
from visitlab_cli.report.tables import UNKNOWN
from visitlab_cli.results.estimates import Estimate

WIDTH, HEIGHT, EDGE = 120, 16, 4  # pixels
Scale = tuple[float, float]


def scale_of(estimates: Iterable[Estimate | None]) -> Scale:
    """The least and the greatest value that the pictures of rows alike show; zero is always among them."""
    ends = [0.0]
    for each in estimates:
        if each is not None:
            half = 0.0 if math.isnan(each.half) else each.half
            ends += [each.mean - half, each.mean + half]
    return min(ends), max(ends)


def picture(estimate: Estimate | None, scale: Scale) -> Html:
    """A mean as a dot on a line, its interval as a bar; in words for those who do not see it."""
    if estimate is None:
        return Html(UNKNOWN)
    low, high = scale
    mean, half = estimate

    def x(value: float) -> str:
        share = (value - low) / (high - low) if high > low else 0.0
        return f"{EDGE + share * (WIDTH - 2 * EDGE):.1f}"

    known = not math.isnan(half)
    middle = HEIGHT // 2
    words = f"{mean - half:z.2f} to {mean + half:z.2f}" if known else "one seed: no interval"
    bar = element("line", x1=x(mean - half), x2=x(mean + half), y1=middle, y2=middle, class_="interval")
    zero = element("line", x1=x(0), x2=x(0), y1=2, y2=HEIGHT - 2, class_="zero") if low < 0 < high else None
    drawn = element(
        "svg",
        element("line", x1=EDGE, x2=WIDTH - EDGE, y1=middle, y2=middle, class_="track"),
        zero,
        bar if known else None,
        element("circle", cx=x(mean), cy=middle, r="3.5", class_="dot"),
        viewBox=f"0 0 {WIDTH} {HEIGHT}",
        width=WIDTH,
        height=HEIGHT,
        aria_hidden="true",
    )
    return element("span", drawn, element("small", words), class_="estimate")
