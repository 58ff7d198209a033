"""The figure of a grid, read back from its axes, on cells written by hand."""

import numpy as np
import pytest

from tests.results.runs_by_hand import open_lab, write_cell
from visitlab_cli.figures.grid_figure import draw_grid
from visitlab_cli.figures.making import make_figures
from visitlab_cli.paper.figures.source import open_source

T_OF_TWO = 4.302653  # Student's t, 2 degrees of freedom, 97.5%


def drawn(tmp_path, vary, reward, seeds=3):
    """The grid of the lab's config, in which every trial of a cell has the reward that is given its point and seed."""
    run, cells = open_lab(tmp_path, seeds=seeds, more=f"record: {{steps: none}}\nvary: {vary}\n")
    for cell in cells.values():
        if cell.experiment != "visit":
            at = {path.split(".")[-1]: value for path, value in cell.point.items()}
            write_cell(run, cell, np.full(cell.trials, reward(at) + cell.seed))
    return run, draw_grid(open_source(run))


def panels(drawing):
    found = {axes.get_title(loc="left").replace("\n", " "): axes for axes in drawing.figure.axes}
    return {title: axes for title, axes in found.items() if title}


def line(axes, gid):
    (found,) = [each for each in axes.lines if each.get_gid() == gid]
    return list(found.get_xdata()), list(found.get_ydata())


def test_the_level_lies_over_the_varied_number_in_its_order(tmp_path):
    _, drawing = drawn(tmp_path, "{agents.mf.alpha: [0.5, 0.1, 0.3]}", lambda at: 10 * at.get("alpha", 0))
    axes = panels(drawing)["navigation: level against alpha"]
    assert axes.get_xlabel() == "alpha"
    x, y = line(axes, "level/navigation/agents.mf.alpha/mf")
    assert (x, y) == ([0.1, 0.3, 0.5], pytest.approx([2.0, 4.0, 6.0]))
    bars = axes.collections[0].get_segments()
    assert [(high - low) / 2 for (_, low), (_, high) in bars] == pytest.approx([T_OF_TWO / np.sqrt(3)] * 3, rel=1e-5)
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["mf", "mb"]  # mb does not depend on it
    assert axes.get_ylabel() == "reward a trial, last tenth\n(mean, n = 3 seeds)"
    curves = panels(drawing)["navigation: mf"]
    assert [text.get_text() for text in curves.get_legend().get_texts()] == ["0.1", "0.3", "0.5"]
    assert line(curves, "navigation/mf/agents.mf.alpha=0.3")[1] == pytest.approx([4.0] * 20)


def test_words_and_whole_entries_are_places_with_what_differs(tmp_path):
    humans = "[{p_S: [1, 0, 0]}, {p_S: [1, 0, 0], p_A: 0.5, p_H: 0.1}]"
    _, drawing = drawn(tmp_path, f"{{agents.mb.unvisited: [uniform, zero], humans.slow: {humans}}}", lambda at: 5.0)
    found = panels(drawing)
    words = [tick.get_text() for tick in found["go_to_human: level against unvisited"].get_xticklabels()]
    assert words == ["uniform", "zero"]
    words = [tick.get_text() for tick in found["social: level against slow"].get_xticklabels()]
    assert words == ["p_H=0.0\np_A=0.0", "p_H=0.1\np_A=0.5"]


def test_many_values_have_a_scale_of_colours_and_many_lines_a_mean(tmp_path, monkeypatch):
    for most in ("MOST_LINES", "MOST_NAMED_CURVES", "MOST_CURVE_PANELS"):
        monkeypatch.setattr(f"visitlab_cli.figures.grid_figure.{most}", 2)
    vary = "{agents.mf.alpha: [0.1, 0.2, 0.4, 0.8], agents.mf.epsilon: [0.1, 0.2, 0.6]}"
    _, drawing = drawn(tmp_path, vary, lambda at: 10 * at.get("alpha", 0) + 100 * at.get("epsilon", 0), seeds=1)
    found = panels(drawing)
    axes = found["navigation: level against alpha"]
    x, y = line(axes, "level/navigation/agents.mf.alpha")
    assert (x, y) == ([0.1, 0.2, 0.4, 0.8], pytest.approx([31, 32, 34, 38]))
    assert axes.get_legend().get_texts()[0].get_text() == "mean over the other settings (3 grey lines)"
    curves = [axes for title, axes in found.items() if title.startswith("navigation: mf · epsilon=")]
    assert len(curves) == 2
    assert all(axes.get_legend() is None and len(axes.lines) == 4 for axes in curves)
    assert "navigation: learning curves of 1 more are not drawn" in drawing.notes


def test_a_run_without_a_grid_has_none(tmp_path):
    run, cells = open_lab(tmp_path)
    for cell in cells.values():
        write_cell(run, cell, np.ones(cell.trials))
    assert draw_grid(open_source(run)) == (None, [])


def test_the_figure_is_a_file_beside_the_others(tmp_path):
    run, _ = drawn(tmp_path, "{agents.mf.alpha: [0.1, 0.5]}", lambda at: 1.0)
    made = make_figures(run, None, ["grid"])
    assert [file.relative_to(run).as_posix() for file in made.files] == ["figures/grid.svg"]
