"""The two tables, in Markdown."""

from estimates import POWER
from programs import K

def table(head, rows):
    """A table in Markdown."""
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def cost_table(cases):
    head = ["scene", "ns per path: Mitsuba", "fredholm", "ratio (range)", "relMSE: Mitsuba", "fredholm", "ratio"]
    head += ["relMSE × s: Mitsuba", "fredholm", "ratio ± se", "command, s: Mitsuba", "fredholm"]
    rows = []
    for case in (case for case in cases if case.timed):
        if case.error:
            rows.append([f"`{case.name}`", case.error] + [""] * (len(head) - 2))
            continue
        c, e, w = case.result["cost"], case.result["rel_mse"], case.result["work"]
        (m, dm), (f, df) = e["mitsuba"], e["fredholm"]
        rows.append([f"`{case.name}`", f"{c['ns']['mitsuba']:.0f}", f"{c['ns']['fredholm']:.0f}"])
        rows[-1] += ["{:.2f} ({:.2f}–{:.2f})".format(c["ratio"], *c["ratio_range"])]
        rows[-1] += [f"{m:.2e} ± {dm / m:.0%}", f"{f:.2e} ± {df / f:.0%}", f"{m / f:.2f}"]
        rows[-1] += [f"{w['mitsuba']:.2e}", f"{w['fredholm']:.2e}", "{:.2f} ± {:.2f}".format(*w["ratio"])]
        rows[-1] += [f"{c['command_seconds'][who]:.2f}" for who in ("mitsuba", "fredholm")]
    return table(head, rows)


def verdict(case):
    """Whether the terms agree, in words."""
    by_k = case.result["terms"]
    wrong = case.differing()
    if not wrong:
        said = "agrees"
    else:
        most = max(abs(c["relative"]) for k in wrong for c in by_k[k] if c["differs"])
        said = f"**differs** at k = {', '.join(map(str, wrong))}, by up to {most:.2%}"
    notes = [f"modelled differently: {note}" for note in case.notes]
    return "; ".join([said, *case.remarks, *notes])


def agreement_table(cases):
    head = ["scene", *(f"k = {k}" for k in range(K + 1)), "result"]
    rows = []
    for case in cases:
        if case.error:
            rows.append([f"`{case.name}`", *[""] * (K + 1), case.error])
            continue
        cell = lambda channels: (
            f"{max(abs(c['z']) for c in channels):.1f} ({max(c['found'] for c in channels):.2%})"
            if any(c["fredholm"] or c["mitsuba"] for c in channels)
            else "no light"
        )
        rows.append([f"`{case.name}`", *map(cell, case.result["terms"]), verdict(case)])
    return table(head, rows)


def report(cases, amounts, machine, comparisons, alarms):
    a = amounts
    per_path = f"{a.rounds} interleaved rounds, slope from {a.time_spp[0]} to {a.time_spp[1]} samples at {a.time_side}²"
    limit = min(c["limit"] for case in cases if not case.error for k in case.result["terms"] for c in k)
    return f"""{machine['date']}, {machine['processor']}, one of them; load {machine['load']} (1 = one busy core). \
fredholm {machine['fredholm']}, Mitsuba {machine['mitsuba']} (`llvm_ad_rgb`, LLVM {machine['llvm']}, one thread).

**Cost and error.** Ratios are Mitsuba / fredholm: above 1, fredholm needs less. ns per path: CPU time, {per_path}. \
relMSE: {a.side}², {a.spp} samples, mean of {a.seeds} seeds. s: ns per path × {a.side}² × {a.spp} paths. command: the whole \
command at {a.side}² and {a.spp} samples, with start-up, pictures and files.

{cost_table(cases)}

**Agreement of the terms.** Largest difference of the image means over three channels, in standard errors; in brackets the \
smallest relative difference that would have been found with probability {POWER:.0%}, in the channel where it is largest. \
A difference counts from {limit:.2f} standard errors on: the probability of a false alarm in all {comparisons} comparisons \
together is {alarms:g}.

{agreement_table(cases)}
"""
