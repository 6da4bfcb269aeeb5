# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of the claims: verdicts first, then the numbers."""
from __future__ import annotations

from collections.abc import Sequence

from statejump.core.tables import markdown
from studies.paper.claims.findings import CHAOTIC, Findings
from studies.paper.claims.measures import MEASURE_RULE, all_claims, measure, measures
from studies.paper.claims.statistics import MRAD, SIGNIFICANCE, TREND_RULE, trend
from studies.paper.claims.verdicts import Claim, jump_verdict, kelvin

CAPTIONS = (
    ("fig13", "Figure 13: paths of the two centres, and of one relative to the other"),
    ("fig14", "Figure 14: deflection of AB against the clearance"),
    ("fig15", "Figure 15: deflection of AB against the friction coefficient"),
    ("fig16", "Figure 16: deflection of AB against the stiffness of the torsion spring"),
)


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    def escaped(cells: Sequence[str]) -> list[str]:
        return [cell.replace("|", "\\|") for cell in cells]

    return markdown(escaped(header), map(escaped, rows))


def _rules_changed(f: Findings, claims: Sequence[Claim], rules: Sequence[str]) -> str:
    """Return a note that verdict rules were changed after the first runs, with the verdicts by the former rules."""
    spring = next(one for one in measures(f) if one.jump is f.jump_by_spring)
    now = measure(spring.jump.absolute(), spring.without, spring.larger)
    before = trend(spring.jump.absolute(), rising=False).verdict
    return (
        "Two rules were changed after the first results of the paper's case. With ten times the spread as the "
        "threshold of rule 1 the first statement of this page would be "
        f"{_former(jump_verdict(f, 10 * f.start_spread_m), claims[0].verdict)}. With a monotone fall, as in "
        f"rule {rules.index(TREND_RULE) + 1}, instead of rule {rules.index(MEASURE_RULE) + 1}, the one on "
        f"{spring.name} would be {_former(before, now)}."
    )


def _former(before: str, now: str) -> str:
    return f"*{before}*, as it is now" if before == now else f"*{before}* instead of *{now}*"


def _certainty(f: Findings) -> list[str]:
    if not f.amplification.is_chaotic:
        return [f"This factor is below {CHAOTIC:g}, so single runs of this case can be compared point by point."]
    static = "" if f.static_rigid_rad is None else "the static value with a spring; "
    ringing = (
        " Links that start at rest ring. The phase of this ringing at the first impact determines the speed of the "
        "impact, so a run can be far from the mean of an ensemble whose starts are spread over "
        f"{f.start_spread_m * 1e6:g} µm."
        if f.rings else ""
    )
    return [
        f"This page calls a motion chaotic if this factor exceeds {CHAOTIC:g}.", "",
        f"- Deterministic: everything up to the first contact, and its temperature; the envelope of θ2; {static}the "
        "statistics of an ensemble.",
        f"- Chaotic: a single run after the first contacts, and its jump.{ringing} The paper's figures "
        "show single runs. Two programs, or two compilers, give different figures of this kind.",
    ]


def page(title: str, command: str, f: Findings) -> list[str]:
    """Return the lines of README.md, the page of verdicts.

    :param command: command that makes the page
    """
    claims = all_claims(f)
    rules = list(dict.fromkeys(claim.rule for claim in claims))
    a = f.amplification
    lines = [
        f"# {title}: the paper's claims, tested", "",
        f"`{command}` makes this page, with its texts and verdicts, from the numbers of the run. Figures 13 to 16 of "
        "Chen et al. (2021), DEM and reduced model on the same axes.", "",
        *_table(
            ("statement", "found", "verdict", "why", "rule"),
            [(c.statement, c.found, f"**{c.verdict}**", c.why, str(rules.index(c.rule) + 1)) for c in claims],
        ),
        "", "± is the standard error of the mean. Rules:", "",
        *(f"{number}. {rule}." for number, rule in enumerate(rules, start=1)),
        "", _rules_changed(f, claims, rules),
        "", "## What is certain and what is chance", "",
        f"Two reduced runs whose AB differs by {a.start_rad:.1e} rad at the start differ by "
        f"{a.at_largest_temperature_rad:.1e} rad at the largest temperature and by {a.at_end_rad:.1e} rad at the end"
        + (f", {a.at_end_rad / a.start_rad:.1e} times as much." if a.start_rad > 0 else "."),
        "", *_certainty(f),
        "", "## First contact", "",
        "In the middle columns, links follow their expansion from the start (`start.mode = \"matched\"`), so they do "
        "not ring. The last columns are of the single runs in the figures.", "",
        *_table(
            ("clearance [mm]", "c/(α |AC|)", "reduced − closed form", "DEM − closed form", "figures: reduced",
             "figures: DEM"),
            [
                (
                    f"{contact.clearance_m * 1e3:g}", kelvin(contact.closed_form_K),
                    _difference(contact.reduced_K, contact.closed_form_K),
                    _difference(contact.dem_K, contact.closed_form_K),
                    kelvin(contact.reduced_ringing_K), kelvin(contact.dem_ringing_K),
                )
                for contact in f.first_contacts
            ],
        ),
        "", "## DEM against reduced model, as ensembles", "",
        f"The tests are Kolmogorov-Smirnov for the distribution, Welch's t for the mean, and Brown-Forsythe for the "
        f"spread, at a significance of {SIGNIFICANCE:g}. {3 * len(f.tests)} such tests of equal models give a false "
        f"alarm with a probability of at most {min(1.0, 3 * len(f.tests) * SIGNIFICANCE):.2g}.", "",
        *_table(
            ("quantity", f"reduced, {len(f.end_shift_reduced_m)} runs", f"DEM, {len(f.end_shift_dem_m)} runs",
             "p distribution", "p mean", "p spread", "models differ"),
            [
                (
                    test.quantity,
                    f"{test.reduced_mean * MRAD:.3f}, sd {test.reduced_sd * MRAD:.3f} mrad",
                    f"{test.dem_mean * MRAD:.3f}, sd {test.dem_sd * MRAD:.3f} mrad",
                    f"{test.p_distribution:.2g}", f"{test.p_mean:.2g}", f"{test.p_spread:.2g}",
                    "no" if test.agree else "**yes**",
                )
                for test in f.tests
            ],
        ),
        "", "## Envelope", "",
        "The table compares θ2 of every sample with the extremes of θ2 at its temperature, over all positions of the "
        "journal in the play, with rigid links. The margin widens the play. It is twice the largest sum of depth "
        "and stretch of both links in the single runs.", "",
        *_table(
            ("runs", "number", "largest excess [µrad]", "margin [µm]", "samples beyond the margin"),
            [
                (e.runs, str(e.count), f"{e.largest_excess_rad * 1e6:.2f}", f"{e.margin_m * 1e6:.3f}",
                 str(e.beyond_margin))
                for e in f.envelopes
            ],
        ),
        "", "## Figures", "",
    ]
    for name, caption in CAPTIONS:
        lines += [f"![{caption}]({name}.png)", "", caption + ".", ""]
    lines += [
        "`ensembles.csv`: largest deflection, range, jump and end of every run; `curves.csv`: the curves of the "
        "figures; `ensembles.json`: everything on this page.",
    ]
    return lines


def _difference(value: float | None, exact: float | None) -> str:
    if value is None or exact is None:
        return "none" if value is exact is None else "**one has none**"
    return f"{value - exact:+.1e} K"
