# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump truss import``: convert a truss of another program to a case file."""
from __future__ import annotations

import os
from functools import partial
from pathlib import Path
from typing import Any

import click

from statejump.cli.terminal import QUIET, make_console, print_table
from statejump.core.errors import NotAllowed, StatejumpError, printable
from statejump.core.output import check_suffix, check_target
from statejump.kinds.loading import parse_case
from statejump.kinds.truss.generate.document import table_path, write
from statejump.kinds.truss.importing import SYSTEMS, Options, Units, case_document, checked, hints, read, summary
from statejump.kinds.truss.sections import sections_in_files
from statejump.schema.json_schema import head_line
from statejump.schema.rules import folder_name

# Keys whose values are out of range if the units of a deck are not SI.
UNIT_KEYS = ("cross_section_area_m2", "young_modulus_Pa", "density_kg_per_m3", "position_m", "mass_kg")
# Of the option --tables.
TABLES: dict[str, Any] = {
    "is_flag": True,
    "help": "Write nodes, links, joints and springs into CSV files beside the case file, one row an item.",
}


def _joint(text: str) -> dict[str, str]:
    found = {}
    for part in text.split(","):
        key, equal, value = part.partition("=")
        if not equal or not key.strip() or key.strip() in found:
            raise NotAllowed("--joint", text, code="bad_joint_option")
        found[key.strip()] = value.strip()
    return found


def _held(text: str) -> tuple[str, str]:
    name, equal, directions = text.rpartition("=")
    if not equal or not name or not directions or set(directions) - set("xyz"):
        raise NotAllowed("--fixed", text, code="bad_fixed_option")
    return name, directions


def _thermal(output: Path, file: Path | None, given: dict[str, float | None]) -> dict[str, dict[str, object]]:
    """Return the sections that members' histories need."""
    for option, value in given.items():
        if value is not None and file is None:
            raise NotAllowed(option, value, code="requires_members_file")
    if file is None:
        return {}
    keys = dict(zip(given, ("reference_temperature_K", "lead_in_s", "lead_out_s")))
    beside = os.path.relpath(file, output.parent)
    said = {keys[option]: value for option, value in given.items() if value is not None}
    # Every row ends a branch, so one increment per branch suffices.
    return {"thermal": {"shape": "table", "members_file": beside, **said}, "reduced": {"increments_per_branch": 1}}


def _refuse_units(file: Path, given: dict[str, str | float | None]) -> None:
    """Raise an error if the user gives options for units although the imported file states its units."""
    for option, value in given.items():
        if value not in (None, "SI"):
            raise NotAllowed(option, value, code="units_in_columns", file=file)


def units_of(system: str | None, length: float | None, force: float | None) -> Units:
    """Return the units of a deck from the options of a command."""
    if system is None:
        return Units(length or 1.0, force or 1.0)
    for option, value in (("--length-unit", length), ("--force-unit", force)):
        if value is not None:
            raise NotAllowed(option, value, code="units_given_twice", system=system)
    return SYSTEMS[system]


@click.command("import")
@click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
@click.option("-o", "--output", required=True, metavar="CASE", type=click.Path(path_type=Path),
              help="Case file to write; its name is that of the case.")
@click.option("--format", "form", type=click.Choice(["abaqus", "nastran", "tables", "mesh"]),
              help="Format of FILE. Without it: by the suffix and the first lines.")
@click.option("--bars", metavar="FILE", type=click.Path(path_type=Path), help="Table of bars beside a table of nodes.")
@click.option("--units", type=click.Choice(["SI", "mm-N", "mm-kN-t", "mm-kg-s", "in-lbf"]),
              help="Units of a deck; mm-kN-t has masses in tonnes, mm-kg-s forces in millinewtons. Without it: SI.")
@click.option("--length-unit", type=click.FloatRange(min=0, min_open=True), metavar="METRES",
              help="Length of one unit of a deck, in place of --units: 0.001 for millimetres.")
@click.option("--force-unit", type=click.FloatRange(min=0, min_open=True), metavar="NEWTON",
              help="Force of one unit of a deck, in place of --units.")
@click.option("--step", type=click.IntRange(min=1), metavar="NUMBER",
              help="Step or subcase of a deck; without it the first one.")
@click.option("--beams-as-bars", is_flag=True, help="Take beams as pin-jointed bars: their bending is left out.")
@click.option("--circ", type=click.Choice(["radius", "diameter"]),
              help="What the one length of SECTION=CIRC is: a radius in Abaqus, a diameter in FreeCAD's decks.")
@click.option("--ignore", "ignored", multiple=True, metavar="CARD",
              help="Leave out a card, or a field CARD.FIELD, that is not supported although it has influence.")
@click.option("--temperature-change", type=float, metavar="KELVIN", help="Of all links, where the deck says nothing.")
@click.option("--young-modulus", "young_modulus_Pa", type=float, metavar="PA",
              help="Of links, where the deck says nothing.")
@click.option("--area", "cross_section_area_m2", type=float, metavar="M2",
              help="Of links, where the deck says nothing.")
@click.option("--thermal-expansion", "thermal_expansion_per_K", type=float, metavar="1/K",
              help="Of links, where the deck says nothing.")
@click.option("--fixed", multiple=True, metavar="NODE=xyz",
              help="Hold a node, or nodes by a pattern, in these directions too.")
@click.option("--density", type=float, metavar="KG/M3", help="Of links whose density the deck does not say.")
@click.option("--members-file", metavar="FILE", type=click.Path(path_type=Path),
              help="Temperatures of every link over time (CSV, HDF5) instead of the deck's.")
@click.option("--reference-temperature", type=float, metavar="KELVIN",
              help="At which links are free of stress, beside --members-file; none: it has changes.")
@click.option("--lead-in", type=float, metavar="SECONDS", help="Way from there to the first row of --members-file.")
@click.option("--lead-out", type=float, metavar="SECONDS", help="Way back from its last row.")
@click.option("--joint", "joints", multiple=True, metavar="node=NAME,...",
              help="Put in a slider on a support (node, axis=x) or in links (link=NAME or pattern, axis=link), with "
                   "friction_coefficient, normal_force_N, ...; or, with link and node, a revolute between that link "
                   "and the others (journal_radius_m, ...). from=FILE: the section that 'statejump identify' wrote.")
@click.option("--reflector", metavar="NODES",
              help="Nodes of a reflecting surface: names or patterns, with commas between them.")
@click.option("--reflector-axis", type=float, nargs=3, default=(0, 0, 1), show_default=True, metavar="X Y Z",
              help="Axis of that surface; of a planar truss Z is left out.")
@click.option("--tables", **TABLES)
@click.option("--force", is_flag=True, help="Overwrite the file.")
@QUIET
def import_command(
    file: Path, output: Path, form: str | None, bars: Path | None, units: str | None, length_unit: float | None,
    force_unit: float | None, step: int | None, beams_as_bars: bool, circ: str | None, ignored: tuple[str, ...],
    temperature_change: float | None, fixed: tuple[str, ...], density: float | None, members_file: Path | None,
    reference_temperature: float | None, lead_in: float | None, lead_out: float | None, joints: tuple[str, ...],
    reflector: str | None, reflector_axis: tuple[float, float, float], tables: bool, force: bool, quiet: bool,
    **links: float | None,
) -> None:
    """A truss of another program as a case file: decks of CalculiX and Abaqus, Nastran bulk data, CSV tables,
    meshes (.vtk, .vtu, .vtp, .msh, .med, .mesh).

    Prints what was taken, what was left out and why, and sizes to check. What has influence and is not supported is
    refused; --ignore leaves it out.

    \b
    Examples:
      statejump truss import mast.bdf -o mast.toml --length-unit 0.001
      statejump truss import mast.bdf -o mast.toml --members-file day.csv --reference-temperature 293.15 --lead-in 3600
    """
    console = make_console(quiet)
    beside = new_files(output, tables, force)
    deck = read(file, form, bars, Options(frozenset(name.lstrip("*").upper() for name in ignored), beams_as_bars, step,
                                          circ))
    if deck.named_units:
        _refuse_units(file, {"--units": units, "--length-unit": length_unit, "--force-unit": force_unit})
    document = case_document(
        deck, folder_name(output.stem), units=units_of(units, length_unit, force_unit),
        temperature_change_K=temperature_change, density_kg_per_m3=density,
        links={key: value for key, value in links.items() if value is not None}, fixed=[_held(text) for text in fixed],
        joints=[_joint(text) for text in joints],
        sections=_thermal(output, members_file, {"--reference-temperature": reference_temperature,
                                                 "--lead-in": lead_in, "--lead-out": lead_out}),
        reflector=None if reflector is None else (reflector.split(","), reflector_axis),
    )
    try:
        case, without_support = checked(document, partial(parse_case, files_from=output.parent))
    except StatejumpError as refused:
        if refused.key in UNIT_KEYS and not refused.remedy and not (units or length_unit or force_unit):
            refused.remedy = "--units mm-N, mm-kN-t, mm-kg-s or in-lbf names the units of the deck"
        raise refused.located(file=file) from None
    left = [f"# Left out: {printable(card)} ({count}): {why}" for card, count, _, why in deck.left_rows()]
    write(document, output, [head_line("truss", output), f"# Imported from {printable(file.name)}", *left,
                             "# Units are in the names."], beside)
    for table in deck.account():
        print_table(table, console)
    print_table(summary(document), console)
    for choice in deck.choices:
        console.print(f"chosen: {choice}")
    unsupported = [without_support] if without_support else []
    for hint in (*unsupported, *hints(document), *case.implausible):
        console.print(f"hint: {hint}")
    beams = f"beams {len(document['beam'])}, " if "beam" in document else ""
    console.print(f"{output}: nodes {len(document['node'])}, links {len(document.get('link', ()))}, {beams}joints "
                  f"{len(document.get('slider', ())) + len(document.get('revolute', ()))}, "
                  f"{'planar' if case['truss.dimension'] == 2 else 'spatial'}")


def new_files(output: Path, tables: bool, force: bool) -> tuple[str, ...]:
    """Return the lists of items that are written to separate files beside the case.

    :param tables: whether to write lists to separate files
    :param force: whether files may be overwritten
    :raises StatejumpError: a file exists already, or cannot be written
    """
    check_suffix("--output", output, ".toml")
    beside = sections_in_files() if tables else ()
    for path in (output, *(table_path(output, section) for section in beside)):
        if os.path.exists(path) and not force:
            raise StatejumpError(code="exists_already", file=path)
    check_target(output)
    return beside
