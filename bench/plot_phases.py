#!/usr/bin/env python3
"""Turns the JSON of clinch_phases into tables in Markdown and, with matplotlib, plots.

usage: bench/plot_phases.py RESULT.json [-o TABLE.md] [--plot DIR]

Without -o the tables go to standard output. DIR gets two files for each scene: SCENE-time.png, time by step of the
splits between the phases (as figure 6.8 of Q. Avril's thesis, INSA Rennes, 2011), and SCENE-units.png, the units of the
broad phase by step (as its figure 6.9).
Needs Python's standard library; --plot needs Debian's python3-matplotlib besides.
"""
import argparse
import json
import os
import sys


def row(cells):
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def head(cells):
    return [row(cells), "|" + "---|" * len(cells)]


def streaming(result):
    scenes, averages = result["streaming"]["scenes"], result["streaming"]["averages"]
    yield f"# Both phases at once: {result['device']}"
    yield ""
    yield (f"One of {result['every']} frames until all rest, some in a row, {result['contacts_per_pair']} contacts a pair at "
           "most; a step's mean / median ms, in brackets by how much less than in sequence (of the means; the median frame's), %")
    yield ""
    ways = [way["name"] for way in averages]
    yield from head(["scene, bodies", "frames", *ways])
    for scene in scenes:
        cells = [f"{way['mean_ms']:,.3g} / {way['median_ms']:,.3g}"
                 + ("" if i == 0 else f" ({way['reduction_percent']:.1f}; {way['median_reduction_percent']:.1f})")
                 for i, way in enumerate(scene["ways"])]
        yield row([f"`{scene['kind']}`, {scene['bodies']:,}", len(scene["measured"]), *cells])
    yield row(["mean of the scenes", "", "", *(f"{way['reduction_percent']:.1f}; {way['median_reduction_percent']:.1f}"
                                               for way in averages[1:])])
    yield ""
    yield from head(["scene", "broad phase, ms", "narrow phase, ms", "pairs at rest", "contacts at rest",
                     "bytes for pairs, most, streamed", "listed"])
    for scene in scenes:
        yield row([f"`{scene['kind']}`", f"{scene['broad_ms']:,.3g}", f"{scene['narrow_ms']:,.3g}",
                   f"{scene['pairs_at_rest']:,}", f"{scene['contacts_at_rest']:,}", f"{scene['most_pair_bytes']:,}",
                   f"{scene['most_listed_pair_bytes']:,}"])


def balance(result):
    yield "# Units moved between the phases (simulated)"
    yield ""
    yield "Assumed, not measured:"
    yield from (f"- {assumption}" for assumption in result["balance"]["assumptions"])
    yield ""
    yield from head(["scene", "units", "steps", "within 10 % of the best fixed split of each step",
                     "the same, loads not smoothed", "moves", "checks"])
    for scene in result["balance"]["scenes"]:
        for run in scene["runs"]:
            yield row([f"`{scene['kind']}`", run["units"], scene["steps"], f"{100 * run['share_near_best']:.1f} %",
                       f"{100 * run['share_near_best_unsmoothed']:.1f} %", run["moves"], run["checks"]])


def document(result):
    yield from streaming(result)
    yield ""
    yield from balance(result)


def splits_shown(units):
    """A few of the fixed splits: all would hide one another."""
    return sorted({1, max(1, units // 4), units // 2, max(1, 3 * units // 4), units - 1})


def plot_time(scene, pyplot, path):
    figure, axes = pyplot.subplots(1, len(scene["runs"]), figsize=(7 * len(scene["runs"]), 5), squeeze=False)
    for axis, run in zip(axes[0], scene["runs"]):
        steps = range(1, scene["steps"] + 1)
        for broad in splits_shown(run["units"]):
            axis.plot(steps, [1e3 * s for s in run["fixed_seconds"][broad - 1]], linewidth=1, alpha=0.6,
                      label=f"{broad} broad, {run['units'] - broad} narrow")
        axis.plot(steps, [1e3 * s for s in run["best_seconds"]], "k--", linewidth=1, label="best split of each step")
        axis.plot(steps, [1e3 * s for s in run["seconds"]], "r", linewidth=1.5, label="balanced")
        axis.set(title=f"{scene['kind']}, {run['units']} units (simulated)", xlabel="step", ylabel="ms")
        axis.set_yscale("log")
        axis.grid(True, which="both", alpha=0.3)
        axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=120)
    pyplot.close(figure)


def plot_units(scene, pyplot, path):
    figure, axes = pyplot.subplots(1, len(scene["runs"]), figsize=(7 * len(scene["runs"]), 5), squeeze=False)
    for axis, run in zip(axes[0], scene["runs"]):
        steps = range(1, scene["steps"] + 1)
        best = [1 + min(range(run["units"] - 1), key=lambda split: run["fixed_seconds"][split][i])
                for i in range(scene["steps"])]
        axis.step(steps, best, "k--", where="mid", linewidth=1, label="best split of each step")
        axis.step(steps, run["broad_units"], "r", where="mid", linewidth=1.5, label="balanced")
        axis.set(title=f"{scene['kind']}, {run['units']} units (simulated)", xlabel="step",
                 ylabel="units of the broad phase", ylim=(0, run["units"]))
        axis.grid(True, alpha=0.3)
        axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=120)
    pyplot.close(figure)


def plot(result, directory):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    os.makedirs(directory, exist_ok=True)
    for scene in result["balance"]["scenes"]:
        plot_time(scene, pyplot, os.path.join(directory, f"{scene['kind']}-time.png"))
        plot_units(scene, pyplot, os.path.join(directory, f"{scene['kind']}-units.png"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("result", metavar="RESULT.json", help="what clinch_phases -o wrote")
    parser.add_argument("-o", "--output", metavar="TABLE.md", help="default: standard output")
    parser.add_argument("--plot", metavar="DIR", help="time, and units of the broad phase, by step: PNGs of each scene")
    arguments = parser.parse_args()
    try:
        with open(arguments.result, encoding="utf-8") as file:
            result = json.load(file)
        text = "\n".join(document(result)) + "\n"
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"plot_phases.py: no result of clinch_phases: {error}")
    if arguments.output:
        with open(arguments.output, "w", encoding="utf-8") as file:
            file.write(text)
    else:
        sys.stdout.write(text)
    if arguments.plot:
        plot(result, arguments.plot)


if __name__ == "__main__":
    main()
