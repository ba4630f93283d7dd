"""A table drawn as cells of colour with a text in each."""

import numpy as np
from matplotlib.colors import to_rgb

DARK = "#3D3D3D"
CELL_SIZE = 8.5


def draw_map(ax, cells, rows, columns, heads, names=None):
    """cells: (row, column) -> (text, colour); without one: not run. heads, names: beside columns and rows."""
    ax.grid(False)
    picture = np.ones((len(rows), len(columns), 3))
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            text, colour = cells.get((row, column), ("", "#FFFFFF"))
            picture[i, j] = to_rgb(colour)
            ax.text(j, i, text, ha="center", va="center", fontsize=CELL_SIZE, color="#FFFFFF" if colour == DARK
                    else "#111111",
                    fontweight="bold" if colour == DARK else "normal")
    ax.imshow(picture, aspect="auto", interpolation="nearest")
    ax.set_xticks(range(len(columns)), heads)
    ax.set_yticks(range(len(rows)), names or rows)
    ax.set_xticks(np.arange(len(columns) - 1) + 0.5, minor=True)
    ax.set_yticks(np.arange(len(rows) - 1) + 0.5, minor=True)
    ax.grid(which="minor", color="#FFFFFF", linewidth=1.2)
    ax.tick_params(which="both", length=0)
    for side in ("left", "bottom"):
        ax.spines[side].set_visible(False)


def heads_of(values):
    heads = []
    for value in values:
        text = (f"{value:g}" if 1e-3 <= abs(value) < 1e3 or value == 0
                else f"{value:.0e}".replace("e+0", "e").replace("e+", "e").replace("e-0", "e-"))
        heads.append(text)
    return heads
