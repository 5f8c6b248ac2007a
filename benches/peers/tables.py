"""The tables, in Markdown."""

from estimates import POWER
from programs import K

ALL = ("mitsuba", "fredholm", "fast")
OURS = ("fredholm", "fast")


def table(head, rows):
    """A table whose first column is text."""
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def digits(x):
    """Two or three digits, as 0.0123 or 1.23·10⁻⁴."""
    if x == 0 or 1e-3 <= abs(x) < 1000:
        return f"{x:.3g}"
    mantissa, power = f"{x:.2e}".split("e")
    return f"{mantissa}·10" + str(int(power)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def percent(x):
    return f"{100 * x:.2g} %" if x < 1 else f"{100 * x:.0f} %"


def name(case):
    return f"`{case.name}`"


def cost_table(cases):
    head = ["scene", "ns per path: Mitsuba", "fredholm", "`--fast`", "ratio", "of all rounds", "command, s: Mitsuba", "fredholm"]
    rows = []
    for case in cases:
        c = case.result["cost"]
        ns = [str(round(c["ns"][who])) for who in ALL]
        command = [digits(c["command_seconds"][who]) for who in ("mitsuba", "fredholm")]
        span = "{:.2f} to {:.2f}".format(*c["ratio_range"]["fredholm"])
        rows.append([name(case), *ns, f"{c['ratio']['fredholm']:.2f}", span, *command])
    return table(head, rows)


def error_table(cases):
    head = ["scene", "relMSE: Mitsuba", "fredholm", "`--fast`", "relMSE × s: Mitsuba", "fredholm", "`--fast`"]
    rows = []
    for case in cases:
        e, w = case.result["rel_mse"], case.result["work"]
        errors = [f"{digits(e[who][0])} ± {percent(e[who][1] / abs(e[who][0]))}" for who in ALL]
        work = ["{} ({:.2f} ± {:.2f})".format(digits(w[who]), *w["ratio"][who]) for who in OURS]
        rows.append([name(case), *errors, digits(w["mitsuba"]), *work])
    return table(head, rows)


def agreement_table(cases):
    def cell(channels):
        if not any(c["fredholm"] or c["mitsuba"] for c in channels):
            return "no light"
        worst, found = max(abs(c["z"]) for c in channels), max(c["found"] for c in channels)
        text = f"{worst:.1f} ({percent(found)})"
        return f"**{text}**" if any(c["differs"] for c in channels) else text

    rows = [[str(k), *(cell(case.result["terms"][k]) for case in cases)] for k in range(K + 1)]
    return table(["k", *map(name, cases)], rows)


def verdict(case):
    """Whether the terms agree, and what was changed or is modelled differently."""
    if case.error:
        return case.error
    wrong = case.differing()
    if wrong:
        most = max(abs(c["relative"]) for k in wrong for c in case.result["terms"][k] if c["differs"])
        said = f"**differs** at k = {', '.join(map(str, wrong))}, by at most {percent(most)}"
    else:
        said = "no term differs"
    notes = [f"modelled differently: {note}" for note in case.notes]
    return "; ".join([said, *case.remarks, *notes])


def report(cases, amounts, machine, comparisons, alarms):
    """All tables, with the way in which they were measured."""
    a = amounts
    good = [case for case in cases if not case.error]
    timed = [case for case in good if case.timed]
    limit = max((c["limit"] for case in good for k in case.result["terms"] for c in k), default=0)
    verdicts = "\n".join(f"- {name(case)}: {verdict(case)}" for case in cases)
    return f"""\
Measured on {machine['date']}, {machine['processor']}, one of them, load {machine['load']}. fredholm {machine['fredholm']}, \
Mitsuba {machine['mitsuba']} (`llvm_ad_rgb`, LLVM {machine['llvm']}), one thread each. Ratios are Mitsuba / fredholm: above 1, \
fredholm needs less.

**Cost of a path.** CPU time: slope of whole commands from {a.time_spp[0]} to {a.time_spp[1]} samples at {a.time_side}², \
medians of {a.rounds} interleaved rounds. The last two columns are the CPU time of the whole command at {a.side}² and {a.spp} \
samples, with start-up and files.

{cost_table(timed)}

**Error and work.** relMSE at {a.side}² and {a.spp} samples, mean ± standard error of {a.seeds} seeds. The seconds are those \
of {a.side}² × {a.spp} paths at the cost above. In brackets: how many times as much Mitsuba needs; its error is that of the two \
relMSE. `--fast` is `fredholm series --fast`.

{error_table(timed)}

**Agreement of the terms.** The largest difference of the image means over three channels, in standard errors. In brackets: \
the smallest relative difference that would have been found with probability {percent(POWER)}, in the channel where it is \
largest. A difference counts above {limit:.2f} standard errors; the probability of a false alarm in all {comparisons} \
comparisons together is {alarms:g}.

{agreement_table(good)}

{verdicts}
"""
