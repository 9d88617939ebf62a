#!/usr/bin/env python3
"""Turns the JSON of clinch_scaling into a table in Markdown and, with matplotlib, a plot.

usage: bench/plot_scaling.py RESULT.json... [-o TABLE.md] [--plot PLOT.png]

Without -o the table goes to standard output. Simulated machines are drawn dashed and named so.
Needs Python's standard library; --plot needs Debian's python3-matplotlib besides.
"""
import argparse
import json
import sys


def machines_of(paths):
    """The machines of all files, in order."""
    machines = []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            machines += json.load(file)["machines"]
    return machines


def label(machine, curve):
    return f"{curve['load']} {curve['bodies']:,.0f}, {curve['devices']} ({machine['machine']})"


def document(machines):
    yield "# Time by the number of devices"
    for machine in machines:
        yield ""
        yield f"## {machine['machine']}: {machine['name']}"
        if machine["assumptions"]:
            yield ""
            yield "Assumed, not measured:"
            yield from (f"- {assumption}" for assumption in machine["assumptions"])
        for curve in machine["curves"]:
            yield ""
            yield f"{curve['load']}, {curve['bodies']:,.0f} bodies, devices: {curve['devices']}"
            yield ""
            yield "| devices | ms | ideal, ms | efficiency | chunks stolen |"
            yield "|---|---|---|---|---|"
            for p in curve["points"]:
                yield (f"| {p['devices']} | {1e3 * p['seconds']:,.4g} | {1e3 * p['ideal_seconds']:,.4g} | "
                       f"{100 * p['efficiency']:.1f} % | {100 * p['stolen']:.1f} % |")


def plot(machines, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, 3, figsize=(18, 5.5))
    shown = [("ms", lambda p: 1e3 * p["seconds"]), ("efficiency, %", lambda p: 100 * p["efficiency"]),
             ("chunks stolen, %", lambda p: 100 * p["stolen"])]
    for axis, (name, value) in zip(axes, shown):
        for machine in machines:
            style = "--" if machine["machine"] == "simulated" else "-"
            for curve in machine["curves"]:
                axis.plot([p["devices"] for p in curve["points"]], [value(p) for p in curve["points"]], style, marker=".",
                          label=label(machine, curve))
        axis.set(xscale="log", xlabel="devices", ylabel=name)
        axis.set_xscale("log", base=2)
        axis.grid(True, which="major", alpha=0.3)
    axes[0].set_yscale("log")
    axes[1].set_ylim(0, 105)
    axes[2].set_ylim(bottom=0)
    axes[0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("results", nargs="+", metavar="RESULT.json", help="what clinch_scaling -o wrote")
    parser.add_argument("-o", "--output", metavar="TABLE.md", help="default: standard output")
    parser.add_argument("--plot", metavar="PLOT.png", help="time, efficiency and stolen chunks by number of devices")
    arguments = parser.parse_args()
    try:
        machines = machines_of(arguments.results)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"plot_scaling.py: no results of clinch_scaling: {error}")
    text = "\n".join(document(machines)) + "\n"
    if arguments.output:
        with open(arguments.output, "w", encoding="utf-8") as file:
            file.write(text)
    else:
        sys.stdout.write(text)
    if arguments.plot:
        plot(machines, arguments.plot)


if __name__ == "__main__":
    main()
