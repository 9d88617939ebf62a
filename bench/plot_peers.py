#!/usr/bin/env python3
"""Turns the JSON of clinch_peers into a table in Markdown and, with matplotlib, a plot.

usage: bench/plot_peers.py RESULT.json... [-o TABLE.md] [--plot PLOT.png]

Of a scene that is in several files the last one counts. Without -o the table goes to standard output.
Needs Python's standard library; --plot needs Debian's python3-matplotlib besides.
"""
import argparse
import json
import sys

# Q. Avril's thesis (INSA Rennes, 2011), table 4.6: boxes -> milliseconds on a Quadro FX 3600M, as published.
THESIS = {1000: 0.25, 5000: 1.09, 10000: 2.35, 50000: 16.62, 100000: 37.91, 500000: 165.49, 1000000: 391.89}


def scenes_of(paths):
    """The scenes of all files, in order, and the processors they ran on."""
    scenes, processors = {}, []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            content = json.load(file)
        machine = f"{content['processor']}, {content['threads']} threads"
        if machine not in processors:
            processors.append(machine)
        for scene in content["scenes"]:
            scenes[scene["kind"], scene["boxes"], scene["seed"]] = scene
    return list(scenes.values()), processors


def fastest(scene, group):
    """The fastest result of a group that found the right pairs, or None."""
    timed = [r for r in scene["results"] if r["group"] == group and r["ms"] is not None and r["right"]]
    return min(timed, key=lambda r: r["ms"], default=None)


def result_of(scene, peer):
    """The result of one peer if it has a time and the right pairs, or None."""
    for r in scene["results"]:
        if r["peer"] == peer and r["ms"] is not None and r["right"]:
            return r
    return None


def number(value):
    """Three digits."""
    if value >= 100:
        return f"{value:,.0f}"
    return f"{value:.3g}" if value >= 0.001 else f"{value:.4f}"


def time_of(result, name=True):
    if result is None:
        return "-"
    return number(result["ms"]) + (f" ({result['peer'].replace('clinch/', '')})" if name else "")


def ratio(over, under):
    return f"{over['ms'] / under['ms']:.2f}" if over and under else "-"


def fastest_of_order(scene, order):
    own = [r for r in scene["results"]
           if r["peer"].startswith("clinch/") and r["peer"].endswith("/" + order) and r["ms"] is not None and r["right"]]
    return min(own, key=lambda r: r["ms"], default=None)


def main_table(scenes):
    yield ("| scene | boxes | pairs | best library, ms | clinch auto sorted, ms | clinch auto any, ms | library / clinch any "
           "| best clinch any, ms | yardstick, ms | best clinch any / yardstick | thesis 2011, ms |")
    yield "|---|---|---|---|---|---|---|---|---|---|---|"
    for scene in scenes:
        library, yardstick = fastest(scene, "library"), fastest(scene, "yardstick")
        in_order, any_order = result_of(scene, "clinch/auto/sorted"), result_of(scene, "clinch/auto/any")
        best = fastest_of_order(scene, "any")
        thesis = THESIS.get(scene["boxes"]) if scene["kind"] == "uniform" else None
        yield " | ".join([f"| {scene['kind']}", f"{scene['boxes']:,}", f"{scene['pairs']:,}", time_of(library),
                          time_of(in_order, False), time_of(any_order, False), ratio(library, any_order), time_of(best),
                          time_of(yardstick), ratio(best, yardstick), f"{number(thesis) if thesis else ''} |"])


def peer_table(scenes):
    """Every peer's time on every scene."""
    peers = []
    for scene in scenes:
        peers += [r["peer"] for r in scene["results"] if r["peer"] not in peers]
    yield "| ms | " + " | ".join(f"{s['kind']} {s['boxes']:,}" for s in scenes) + " |"
    yield "|---|" + "---|" * len(scenes)
    for peer in peers:
        cells = []
        for scene in scenes:
            r = next((r for r in scene["results"] if r["peer"] == peer), None)
            if r is None:
                cells.append("")
            elif r["ms"] is None:
                cells.append(r["note"] or "-")
            else:
                share = "" if r["right"] else f", **{r['pairs']:,} of {scene['pairs']:,} pairs**"
                cells.append(number(r["ms"]) + share)
        yield f"| {peer} | " + " | ".join(cells) + " |"


def document(scenes, processors):
    yield "# clinch beside other libraries"
    yield ""
    yield f"{'; '.join(processors)}. Medians of `clinch_peers`: from boxes in host memory to pairs readable there. The fastest"
    yield "library is in brackets, right pairs provided. The thesis' figures (table 4.6, Quadro FX 3600M) are as published."
    yield ""
    yield from main_table(scenes)
    yield ""
    yield "## Every peer"
    yield ""
    yield from peer_table(scenes)


def plot(scenes, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    kinds = list(dict.fromkeys(s["kind"] for s in scenes))
    columns = min(2, len(kinds))
    rows = (len(kinds) + columns - 1) // columns
    figure, axes = pyplot.subplots(rows, columns, figsize=(7 * columns, 5 * rows), squeeze=False)
    for axis in list(axes.flat)[len(kinds):]:
        axis.set_visible(False)
    for axis, kind in zip(axes.flat, kinds):
        lines = {}
        for scene in sorted((s for s in scenes if s["kind"] == kind), key=lambda s: s["boxes"]):
            for r in scene["results"]:
                shown = not r["peer"].startswith("clinch/") or r["peer"].startswith("clinch/auto/")
                if shown and r["ms"] is not None and r["right"]:
                    lines.setdefault((r["peer"], r["group"]), []).append((scene["boxes"], r["ms"]))
        for (peer, group), points in lines.items():
            style = {"clinch": dict(linewidth=2.5, marker="o"), "yardstick": dict(linestyle="--", color="black", marker="x")}
            axis.plot(*zip(*points), label=peer, **style.get(group, dict(linewidth=1, marker=".")))
        if kind == "uniform":
            axis.plot(THESIS.keys(), THESIS.values(), label="thesis 2011 (GPU), as published", color="grey", linestyle=":",
                      marker="s")
        axis.set(title=kind, xscale="log", yscale="log", xlabel="boxes", ylabel="ms")
        axis.grid(True, which="major", alpha=0.3)
        axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("results", nargs="+", metavar="RESULT.json", help="what clinch_peers -o wrote")
    parser.add_argument("-o", "--output", metavar="TABLE.md", help="default: standard output")
    parser.add_argument("--plot", metavar="PLOT.png", help="time by number of boxes for each kind of scene")
    arguments = parser.parse_args()
    try:
        scenes, processors = scenes_of(arguments.results)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"plot_peers.py: no results of clinch_peers: {error}")
    text = "\n".join(document(scenes, processors)) + "\n"
    if arguments.output:
        with open(arguments.output, "w", encoding="utf-8") as file:
            file.write(text)
    else:
        sys.stdout.write(text)
    if arguments.plot:
        plot(scenes, arguments.plot)


if __name__ == "__main__":
    main()
