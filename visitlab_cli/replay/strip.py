"""A trial as a comic strip, after the paper's Fig. 9: its moments as panels, drawn to be printed in a paper."""

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.origin import METADATA
from visitlab_cli.pictures.words import in_lines, width_of
from visitlab_cli.replay import panel
from visitlab_cli.same_pictures import same_pictures
from visitlab_cli.scene.colours import (
    DESIRED,
    FACING_FIELD,
    GOAL_FLOOR,
    HUMAN,
    REACHED_FLOOR,
    ROBOT,
    SHUT,
    VISUAL_FIELD,
    shares,
)
from visitlab_cli.scene.moments import left_out, moments, strip_steps
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.shapes import Body, Role
from visitlab_cli.scene.trial import Trial, load_trial
from visitlab_cli.scene.words import LEVEL_NAMES, action_name, direction_name, model_changes, model_name, shut_in
from visitlab_cli.whole_file import write_again
from visitlab_cli.wording import few
from visitlab_cli.world.sight import Walls

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMNS = 4
PANEL, TITLE, GAP = 1.72, 0.3, 0.06
"""In inches: the side of a panel, the height of its title, what lies between; four fill a page of two columns."""
CORNERS = ((0.97, 0.03, "right"), (0.03, 0.03, "left"))
"""Where a panel names its moments: x and y as shares of it, and the side of the words that is there."""
MOMENT_LINE, AROUND = 0.11, 0.9
"""In inches: a line of these; in cells: what robot and human need around them."""
KEY_GAP, KEY_LINE, KEY_ENTRY, KEY_LETTER = 0.06, 0.14, 0.35, 0.052
"""In inches: what is above the lines that explain colours, the height of one, an entry but its letters, a letter."""
FONT_SIZE = 6.5
MOST_DOORS = 4
"""So many shut doors are named."""
IN_ONE_CELL = "both in one cell"
PIXELS_PER_INCH = 300
ENDINGS = (".png", ".svg", ".pdf")


def save_strip(trial: Trial, target: Path) -> None:
    """Write the strip as .png, .svg or .pdf.

    Raises:
        UsageError: another ending, or what is there is not visitlab's.
        RunError: matplotlib is missing, or the target cannot be written.
    """
    ending = target.suffix.lower()
    if ending not in ENDINGS:
        raise UsageError(f"--strip {target}: must end in {', '.join(ENDINGS)}")
    content = BytesIO()
    try:
        with same_pictures({"font.size": FONT_SIZE}):
            draw_strip(trial, strip_steps(trial.steps, trial.lab)).savefig(
                content, format=ending[1:], dpi=PIXELS_PER_INCH, metadata=METADATA[ending[1:]]
            )
    except ModuleNotFoundError as error:
        raise RunError("a strip needs matplotlib; install it with pip install matplotlib") from error
    write_again(target, content.getvalue())


def strip(log: Path, number: int) -> "Figure":
    """A recorded trial of a log as a strip."""
    trial = load_trial(log, number)
    return draw_strip(trial, strip_steps(trial.steps, trial.lab))


def draw_strip(trial: Trial, steps: Sequence[int]) -> "Figure":
    """A panel for each of `steps`, in the order of reading."""
    from matplotlib.figure import Figure

    columns = min(COLUMNS, len(steps))
    rows = -(-len(steps) // columns)
    width = columns * (PANEL + GAP) + GAP
    scene = Scene(trial)
    handles = _key(scene, steps)
    widths = [KEY_ENTRY + KEY_LETTER * len(handle.get_label()) for handle in handles]
    entries = len(handles) if sum(widths) <= width else min(len(handles), max(1, int(width / max(widths))))
    told = in_lines(" ".join(_told(trial, steps)), width - 2 * GAP, FONT_SIZE)
    below = KEY_LINE * (told.count("\n") + 1) if told else 0.0
    key = KEY_GAP + KEY_LINE * -(-len(handles) // entries) + below
    (left, right), (upper, lower) = scene.view
    panel_height = PANEL * min(1.0, (lower - upper) / (right - left))
    height = rows * (panel_height + TITLE + GAP) + GAP + key
    figure = Figure(figsize=(width, height))
    walled = trial.has_rooms and isinstance(trial.lab.walls, Walls)
    grid = figure.subplots(rows, columns, squeeze=False)
    top, bottom = 1 - (TITLE + GAP) / height, (GAP + key) / height
    figure.subplots_adjust(left=GAP / width, right=1 - GAP / width, top=top, bottom=bottom)
    figure.subplots_adjust(wspace=GAP / PANEL, hspace=(TITLE + GAP) / panel_height)
    for axes in grid.flat[len(steps) :]:
        axes.set_axis_off()
    for axes, step in zip(grid.flat, steps, strict=False):
        panel.draw(axes, scene, step)
        axes.spines[:].set(linewidth=0.4, color="0.5")
        kinds = ", ".join(kind for at, kind in moments(trial.steps, trial.lab) if at == step)
        shared = [IN_ONE_CELL] if scene.share_a_cell(step) else []
        wide = max(width_of(kinds, FONT_SIZE, "bold"), *(width_of(words, FONT_SIZE) for words in (*shared, "")))
        high = MOMENT_LINE * (1 + len(shared))
        x, y, side = _free_corner(scene, step, (wide / PANEL, high / panel_height))
        look: Any = {"transform": axes.transAxes, "ha": side, "zorder": 7}
        if kinds and walled:
            look["bbox"] = {"boxstyle": "square,pad=0.15", "facecolor": "white", "alpha": 0.8, "linewidth": 0}
        axes.text(x, y, kinds, weight="bold", **look)
        for words in shared:
            axes.text(x, y + 0.09, words, **look)
        axes.set_title("\n".join(title_of(trial, step)), fontsize=FONT_SIZE, loc="left", pad=2.5, linespacing=1.15)
    if told:
        figure.text(0.5, (KEY_GAP / 2 + below / 2) / height, told, ha="center", va="center")
    spacing: Any = {"handlelength": 1.2, "handletextpad": 0.4, "columnspacing": 1.2, "borderaxespad": 0.1}
    place: Any = {"loc": "lower center", "bbox_to_anchor": (0.5, below / height)}
    figure.legend(handles=handles, ncols=entries, frameon=False, fontsize=FONT_SIZE, **place, **spacing)
    return figure


def _told(trial: Trial, steps: Sequence[int]) -> list[str]:
    """Sentences below the panels: by which of several models the robot acts, and what is not shown."""
    models = [f"Acts by {model_name(trial.steps, 0)}"] if trial.has_models else []
    models += [f"from step {step} on by {model_name(trial.steps, step)}" for step in model_changes(trial.steps)]
    missing = left_out(trial.steps, steps, trial.lab)
    return [f"{words}." for words in (", ".join(models), f"Not shown: {missing}" if missing else "") if words]


def _free_corner(scene: Scene, step: int, size: tuple[float, float]) -> tuple[float, float, str]:
    """Where words of a size lie, and which of their sides: the first corner of a panel with nobody in, of `CORNERS`.

    All are in shares of the panel, from its lower left.
    """
    (left, right), (upper, lower) = scene.view
    taken = [
        ((float(x) - left) / (right - left), (lower - float(y)) / (lower - upper))
        for body in scene.moment(step)
        if isinstance(body, Body)
        for x, y in (body.place, body.tip)
    ]

    def is_free(x: float, y: float, side: str) -> bool:
        begin, base = (x - size[0] if side == "right" else x), (y if y < 0.5 else y - 0.02)
        near = AROUND / (right - left)
        across, down = (begin - near, begin + size[0] + near), (base - near, base + size[1] + near)
        return not any(across[0] < at < across[1] and down[0] < height < down[1] for at, height in taken)

    return next((corner for corner in CORNERS if is_free(*corner)), CORNERS[0])


def _key(scene: Scene, steps: Sequence[int]) -> list[Any]:
    """What the colours are, as far as these steps have them."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    trial = scene.trial
    shown = {shape.role for step in steps for shape in scene.moment(step)} | {shape.role for shape in scene.place()}
    body: Any = {"linestyle": "", "markersize": 4.6, "markeredgecolor": "k", "markeredgewidth": 0.4}
    handles: list[Any] = [Line2D([], [], marker="s", color=shares(ROBOT), label="robot", **body)]
    if trial.has_human:
        handles += [
            Line2D([], [], marker="o", color=shares(HUMAN), label="human", **body),
            Patch(facecolor=shares(VISUAL_FIELD), alpha=panel.NEAR_ALPHA, label="the human sees (and farther)"),
            Patch(facecolor=shares(FACING_FIELD), alpha=panel.NEAR_ALPHA, label="it faces"),
        ]
    if Role.DESIRED in shown:
        handles.append(Line2D([], [], color=shares(DESIRED), linewidth=1.6, label="desired direction"))
    square: Any = {"linestyle": "", "marker": "s", "markersize": 5, "markerfacecolor": "none"}
    for who, role, colour in (("robot", Role.WANTED_ROBOT, ROBOT), ("human", Role.WANTED_HUMAN, HUMAN)):
        if role in shown:
            label = f"where the plan wants the {who}"
            handles.append(Line2D([], [], markeredgecolor=shares(colour), label=label, **square))
    if Role.GOAL in shown:
        handles.append(Patch(facecolor=shares(GOAL_FLOOR), label="goal"))
    if Role.SHUT in shown:
        shut = few(shut_in(trial.steps, trial.lab), MOST_DOORS)
        handles.append(Line2D([], [], color=shares(SHUT), linewidth=1.6, label=f"shut door: {shut}"))
    if Role.REACHED in shown:
        handles.append(Patch(facecolor=shares(REACHED_FLOOR), label="just reached"))
    return handles


def _start(trial: Trial) -> str:
    """How the first panel is called: with all of what its phase is, as far as that is not too long."""
    if not trial.phase:
        return "the start"
    short = f"the start, {trial.phase.split(' (')[0]}"
    words = (f"the start, {trial.phase}", trial.phase)
    return next((each for each in words if width_of(f"0: {each}", FONT_SIZE) <= PANEL), short)


def title_of(trial: Trial, step: int) -> tuple[str, str]:
    """Step and action; desired direction and level."""
    words = []
    if trial.has_engagement:
        words.append(f"towards {direction_name(int(trial.steps['desired_direction'][step]))}")
    if trial.has_human:
        words.append(LEVEL_NAMES[int(trial.steps["interaction_level"][step])])
    action = action_name(trial.steps, step).split(": ")[-1].replace(", then is blocked", "") if step else _start(trial)
    return f"{step}: {action}", ", ".join(words)
