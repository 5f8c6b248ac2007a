"""fredholm beside Mitsuba 3: cost of a path, error of an image, and whether both compute the same terms.

    cost       CPU ns per path: slope of whole commands between two numbers of samples, median of interleaved rounds
    error      relMSE of the sum of the terms, k ≤ 8 (estimates.py)
    agreement  image means of T^k E per k and channel, from independent seeds; t tests, one level for all of them

`run` installs what this needs and starts it. README.md documents tables and files.
"""

import argparse
import datetime
import json
import math
import os
import shutil
import sys
from dataclasses import dataclass
from statistics import median

import numpy as np
from estimates import compared, mean_error, ns_per_path, rel_mse
from programs import HERE, OUT, K, Stop, export, llvm, mitsuba, processor, run, series, sum_of_terms
from scenes import cases, mesh
from tables import report, verdict

ALARMS = 1e-3  # probability of a false alarm in a whole run


@dataclass
class Amounts:
    """How much is computed."""

    rounds: int
    time_side: int  # pixels of an image that is timed
    time_spp: tuple
    side: int  # pixels of an image whose error is measured
    spp: int
    seeds: int


FULL = Amounts(rounds=5, time_side=128, time_spp=(32, 288), side=64, spp=64, seeds=32)
QUICK = Amounts(rounds=1, time_side=32, time_spp=(4, 64), side=32, spp=4, seeds=32)


OURS = {"fredholm": "", "fast": "--fast"}  # what our two columns add to the command

# the measurements


def prepare(case, amounts):
    """Exports the scene in all sizes; the files, or none where Mitsuba has no counterpart."""
    shutil.rmtree(case.folder, ignore_errors=True)
    case.scene = case.scene or mesh()
    few, many = ((amounts.time_side, spp) for spp in amounts.time_spp)
    try:
        files = {amount: export(case, *amount) for amount in {(amounts.side, amounts.spp), few, many}}
    except Stop as e:
        case.error = next((line for line in str(e).splitlines() if line.startswith("error: ")), str(e))
        return None
    case.notes = files[few][1]
    return {amount: file for amount, (file, _) in files.items()}


def terms(case, amounts, file):
    """Term means [seeds, K + 1, 3] of both programs, and sums [seeds, pixels] of both and of `--fast`."""
    mitsuba("terms", file, case.folder / "terms.npz", amounts.seeds)
    theirs = np.load(case.folder / "terms.npz")
    means, sums = [], {who: [] for who in OURS}
    for seed in range(amounts.seeds):
        for who, how in OURS.items():
            series(case, amounts.side, amounts.spp, seed, how)
            sums[who].append(sum_of_terms(case.folder / "ours").ravel())
            if who == "fredholm":
                summary = json.loads((case.folder / "ours/summary.json").read_text())
                means.append([term["mean"] for term in summary["terms"]])
    sums = {who: np.array(images) for who, images in sums.items()}
    return (np.array(means), theirs["means"]), {**sums, "mitsuba": theirs["sums"].reshape(amounts.seeds, -1)}


def agreement(ours, theirs, alpha):
    """One comparison per term and channel."""
    test = lambda k, c: compared(ours[:, k, c].tolist(), theirs[:, k, c].tolist(), alpha)
    return [[test(k, c) for c in range(3)] for k in range(K + 1)]


def errors(sums, other):
    """relMSE with its standard error: each image against the other images of its renderer, and all images of the other one."""
    reference = other.mean(0).tolist()
    rest = [(sums.sum(0) - image) / (len(sums) - 1) for image in sums]
    return mean_error([rel_mse(i.tolist(), own.tolist(), reference) for i, own in zip(sums, rest)])


def time(case, amounts, files):
    """CPU seconds of the three commands of each program, one after the other."""
    sizes = [(amounts.side, amounts.spp)] + [(amounts.time_side, spp) for spp in amounts.time_spp]
    seconds = {who: [] for who in (*OURS, "mitsuba")}
    for size in sizes:
        for who, how in OURS.items():
            seconds[who].append(series(case, *size, how=how))
        seconds["mitsuba"].append(mitsuba("image", files[size], case.folder / "theirs.exr"))
    case.rounds.append(seconds)


def costs(case, amounts):
    """Cost per path, cost of the command and their ratios, from the rounds."""
    paths = [amounts.time_side**2 * spp for spp in amounts.time_spp]
    of = lambda rounds, who: ns_per_path([r[who][1:] for r in rounds], paths)
    each = {who: [of([r], "mitsuba") / of([r], who) for r in case.rounds] for who in OURS}
    all = (*OURS, "mitsuba")
    return {
        "ns": {who: of(case.rounds, who) for who in all},
        "ratio": {who: median(ratios) for who, ratios in each.items()},
        "ratio_range": {who: [min(ratios), max(ratios)] for who, ratios in each.items()},
        "command_seconds": {who: median(r[who][0] for r in case.rounds) for who in all},
    }


def positive(text):
    """A whole number from 1 on."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"`{text}` is not a whole number from 1 on")
    return int(text)


def arguments():
    text = "fredholm beside Mitsuba 3, on one core. README.md in this folder explains the tables."
    p = argparse.ArgumentParser(prog="benches/peers/run", description=text)
    p.add_argument("--scenes", metavar="A,B", help="only these: " + ", ".join(case.name for case in cases()))
    p.add_argument("--rounds", type=positive, metavar="N", help=f"interleaved rounds of timing [default: {FULL.rounds}]")
    p.add_argument("--core", type=int, metavar="N", help="the core to use [default: the last one]")
    p.add_argument("--quick", action="store_true", help="tiny images: checks that everything works, measures nothing")
    return p.parse_args()


def chosen(names):
    all = cases()
    if names is None:
        return all
    wanted = [name.strip() for name in names.split(",")]
    for name in wanted:
        if name not in [case.name for case in all]:
            raise Stop(f"no scene `{name}`\nhelp: one of {', '.join(case.name for case in all)}")
    return [case for case in all if case.name in wanted]


def measure(all, amounts, comparisons):
    """Fills the results of all scenes."""
    say = lambda text: print(text, file=sys.stderr, flush=True)
    files = {}
    for i, case in enumerate(all):
        say(f"{i + 1}/{len(all)} {case.name}: terms from {amounts.seeds} seeds")
        files[case.name] = prepare(case, amounts)
        if case.error:
            say(case.error)
            continue
        means, sums = terms(case, amounts, files[case.name][amounts.side, amounts.spp])
        case.result["terms"] = agreement(*means, ALARMS / comparisons)
        other = lambda who: sums["fredholm" if who == "mitsuba" else "mitsuba"]
        case.result["rel_mse"] = {who: errors(images, other(who)) for who, images in sums.items()}
        say(f"  {verdict(case)}")
        if case.timed:  # Mitsuba keeps compiled kernels on disk: this compiles them
            mitsuba("image", files[case.name][amounts.time_side, amounts.time_spp[0]], case.folder / "theirs.exr")
    timed = [case for case in all if case.timed and not case.error]
    try:
        for r in range(amounts.rounds):
            for case in timed:
                say(f"round {r + 1}/{amounts.rounds}: {case.name}")
                time(case, amounts, files[case.name])
    except KeyboardInterrupt:
        amounts.rounds = min(len(case.rounds) for case in timed)
        if amounts.rounds == 0:
            raise
        say(f"interrupted: the tables hold the {amounts.rounds} complete rounds")
        for case in timed:
            del case.rounds[amounts.rounds :]
    for case in timed:
        case.result["cost"] = cost = costs(case, amounts)
        e, paths = case.result["rel_mse"], amounts.side**2 * amounts.spp
        work = {who: e[who][0] * cost["ns"][who] * 1e-9 * paths for who in e}
        case.result["work"] = {**work, "ratio": {who: work_ratio(cost, e, who) for who in OURS}}


def work_ratio(cost, e, who):
    """Mitsuba's relMSE × s over ours, with the error that comes from the two relMSE."""
    ratio = cost["ratio"][who] * e["mitsuba"][0] / e[who][0]
    return ratio, ratio * math.hypot(*(e[w][1] / e[w][0] for w in ("mitsuba", who)))


def main():
    a = arguments()
    amounts = QUICK if a.quick else FULL
    amounts.rounds = a.rounds or amounts.rounds
    all = chosen(a.scenes)
    run([os.environ["FREDHOLM"], "--version"])  # does it start?
    library, version = llvm()
    os.environ["DRJIT_LIBLLVM_PATH"] = library
    core = max(os.sched_getaffinity(0)) if a.core is None else a.core
    if core not in os.sched_getaffinity(0):
        raise Stop(f"core {core} is not available\nhelp: one of {sorted(os.sched_getaffinity(0))}")
    os.sched_setaffinity(0, {core})  # for this program and all that it starts
    loads = [os.getloadavg()[0]]
    comparisons = len(all) * (K + 1) * 3
    measure(all, amounts, comparisons)
    loads.append(os.getloadavg()[0])
    machine = {
        "date": datetime.date.today().isoformat(),
        "processor": processor(),
        "core": core,
        "load": " to ".join(f"{load:.1f}" for load in loads),
        "llvm": version,
        "fredholm": run([os.environ["FREDHOLM"], "--version"])[1].split()[-1],
        "mitsuba": next(x for x in (HERE / "requirements.txt").read_text().split() if "mitsuba" in x).split("==")[1],
    }
    text = report(all, amounts, machine, comparisons, ALARMS)
    stem = "quick" if a.quick else "peers"
    (OUT / f"{stem}.md").write_text(text)
    whole = {"machine": machine, "amounts": vars(amounts), "alarms": ALARMS, "comparisons": comparisons}
    keep = ("name", "remarks", "notes", "error", "rounds", "result")
    whole["scenes"] = [{key: getattr(case, key) for key in keep} for case in all]
    (OUT / f"{stem}.json").write_text(json.dumps(whole, indent=1) + "\n")
    print(text)
    if a.quick:
        print("note: with --quick these figures only show that everything works", file=sys.stderr)
    # a difference that the exporter has not announced
    return int(any(case.differing() and not case.notes for case in all))


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Stop as e:
        print(f"error: {e}", file=sys.stderr)
        sys.exit(3)
    except KeyboardInterrupt:
        sys.exit(130)
