#!/usr/bin/env python3
"""Draws what clinch_accuracy measured: time against error of each cell, with the cursor's choices.

usage: bench/plot_accuracy.py ACCURACY.json -o PLOT.svg

Needs Debian's python3-matplotlib.
"""
import argparse
import json
import sys

LEAST = 1e-17  # errors of 0 are drawn here

# How a kind of candidate looks: routine, where, bits -> colour, marker, label.
STYLES = {
    ("own", "host", 64): ("tab:blue", "o", "own routine, float64, host"),
    ("own", "host", 32): ("tab:cyan", "o", "own routine, float32, host"),
    ("own", "device", 64): ("tab:red", "s", "own routine, float64, device"),
    ("own", "device", 32): ("tab:orange", "s", "own routine, float32, device"),
    ("gjk-epa", "host", 64): ("tab:blue", ".", "GJK/EPA, float64, host, to a tolerance"),
    ("gjk-epa", "host", 32): ("tab:cyan", ".", "GJK/EPA, float32, host, to a tolerance"),
    ("libccd-gjk-epa", "host", 64): ("tab:grey", "x", "libccd GJK/EPA (overlaps only)"),
    ("libccd-mpr", "host", 64): ("tab:grey", "+", "libccd MPR (overlaps only)"),
}


def point(candidate):
    figures = candidate["all"]
    return figures["ns"], max(figures["p99.9"], LEAST)


def on_host(cell, row):
    """The host candidate that stands for a row of the cursor's choice, or None."""
    if row is None:
        return None
    for candidate in cell["candidates"]:
        tolerance = candidate.get("tolerance")
        wanted = row.get("tolerance")
        same = tolerance == wanted or (tolerance and wanted and abs(tolerance / wanted - 1) < 1e-5)
        # Without a tolerance of its own, the row is the cell's own routine or the general one as it comes.
        name = "own" if wanted is None and not row["general"] else "gjk-epa"
        if candidate["where"] == "host" and candidate["bits"] == row["bits"] and same and candidate["routine"] == name:
            return candidate
    return None


def draw_choices(axis, cell):
    marked = {}
    for choice in cell["choices"]:
        what = f"p {choice['precision']:g}" if "precision" in choice else f"{choice['tolerance']:.0e}".replace("e-0", "e-")
        row = choice["float64"] if choice["passes"] == "float64" else choice["float32"]
        candidate = on_host(cell, row)
        if candidate is not None:
            marked.setdefault(point(candidate), []).append(what + ("+" if choice["passes"] == "float32 then float64" else ""))
    for place, names in marked.items():
        axis.plot(*place, marker="o", markersize=11, fillstyle="none", color="black", linestyle="none")
        axis.annotate(" ".join(names[:3]) + ("\n" + " ".join(names[3:]) if names[3:] else ""), place, xytext=(7, 5),
                      textcoords="offset points", fontsize=5)


def draw_cell(axis, cell):
    front = sorted(point(c) for c in cell["candidates"] if c["front"] and c["promises"] and c["where"] == "host")
    if front:
        axis.step(*zip(*front), where="post", color="black", linewidth=0.6, alpha=0.5)
    for candidate in cell["candidates"]:
        style = STYLES.get((candidate["routine"], candidate["where"], candidate["bits"]))
        if style and candidate["all"].get("ns"):
            axis.plot(*point(candidate), marker=style[1], color=style[0], linestyle="none", markersize=5)
    draw_choices(axis, cell)
    axis.set(xscale="log", yscale="log", xlim=(5, 5e4), ylim=(LEAST / 2, 2))
    axis.set_title(cell["classes"], fontsize=8)
    axis.tick_params(labelsize=6)
    axis.grid(True, which="major", alpha=0.3)


def plot(content, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    cells = content["cells"]
    columns = min(4, len(cells))
    rows = -(-len(cells) // columns)
    figure, axes = pyplot.subplots(rows, columns, figsize=(4 * columns, 2.6 * rows + 1), squeeze=False)
    for axis in list(axes.flat)[len(cells):]:
        axis.set_visible(False)
    for axis, cell in zip(axes.flat, cells):
        draw_cell(axis, cell)
    legend = figure.add_subplot(rows, columns, len(cells) + 1) if len(cells) < rows * columns else axes.flat[0]
    if legend is not axes.flat[0]:
        legend.axis("off")
    for style in STYLES.values():
        legend.plot([], [], marker=style[1], color=style[0], linestyle="none", label=style[2])
    legend.plot([], [], marker="o", fillstyle="none", color="black", linestyle="none", markersize=11,
                label="the cursor's choice at a precision (p) or a\nrelative tolerance; +: then float64")
    legend.legend(loc="center", fontsize=7)
    figure.supxlabel("ns a pair")
    figure.supylabel("error relative to the pair's size, 99.9 %")
    figure.tight_layout()
    figure.savefig(path, dpi=90)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("result", metavar="ACCURACY.json", help="what clinch_accuracy --json wrote")
    parser.add_argument("-o", "--output", metavar="PLOT.svg", required=True, help="an .svg or a .png")
    arguments = parser.parse_args()
    try:
        with open(arguments.result, encoding="utf-8") as file:
            content = json.load(file)
        cells = content["cells"]
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"plot_accuracy.py: no result of clinch_accuracy: {error}")
    if not cells:
        sys.exit("plot_accuracy.py: there is no cell in it")
    plot(content, arguments.output)


if __name__ == "__main__":
    main()
