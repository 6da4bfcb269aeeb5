# SPDX-License-Identifier: GPL-3.0-or-later
"""Layout of a result file, as data. Tests check the writer against the layout, and the reader checks files with it. The
table in docs/reference/result_file.md is generated from it."""
from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property

FORMAT = "statejump result"
VERSION = 1  # increased when older readers would misread a new file
SUFFIX = ".h5"
MODELS = ("reduced", "dem")


@dataclass(frozen=True)
class Form:
    """Types and shapes that an entry of a result file may have.

    :param types: ``group``, ``text``, ``bool``, ``int64``, ``uint8`` (with labels) or ``float64``
    :param shapes: for each allowed shape the names of the axes; if an axis has a fixed length, its name is this length
    :param words: name of the types for the documentation
    """

    types: tuple[str, ...]
    shapes: tuple[tuple[str, ...], ...] = ((),)
    words: str = ""

    def __str__(self) -> str:
        shapes = [f"[{', '.join(axes)}]" for axes in self.shapes if axes]
        several = [", ".join(shapes[:-1]), shapes[-1]] if len(shapes) > 1 else shapes
        return " ".join(filter(None, [self.words or " or ".join(self.types), " or ".join(several)]))


def _array(types: str, *axes: str) -> Form:
    return Form(tuple(types.split()), (axes,))


@dataclass(frozen=True)
class Entry:
    """An entry of a result file. In ``path``, ``{model}`` is a model, ``{name}`` any name; ``@`` marks an attribute."""

    path: str
    form: Form
    meaning: str
    required: bool = True

    @cached_property
    def _pattern(self) -> re.Pattern[str]:
        return re.compile(re.escape(self.path).replace(r"\{model\}", "(?:" + "|".join(MODELS) + ")")
                          .replace(r"\{name\}", "[^/@]+"))

    def matches(self, path: str) -> bool:
        """Return whether a path in a file belongs to this entry."""
        return self._pattern.fullmatch(path) is not None


GROUP, TEXT, BOOL = Form(("group",)), Form(("text",)), Form(("bool",))
WHOLE, NUMBER = Form(("int64",)), Form(("float64",))
COLUMN = Form(("float64", "uint8"), (("samples",), ("samples", "items"), ("samples", "items", "3")),
              "float64, or uint8 with labels")

ENTRIES = (
    Entry("/@format", TEXT, f'"{FORMAT}"'),
    Entry("/@layout_version", WHOLE, f"{VERSION}; a reader refuses a newer one"),
    Entry("/@complete", BOOL, "false: the run was interrupted"),
    Entry("/@command", TEXT, "command that wrote the file: reduced, dem, compare or truss answers"),
    Entry("/case", GROUP, "the case"),
    Entry("/case@name", TEXT, "name of the case"),
    Entry("/case@kind", TEXT, "kind of the case"),
    Entry("/case@title", TEXT, "one line for figures and tables"),
    Entry("/case@source", TEXT, "where its numbers come from"),
    Entry("/case/text", TEXT, "the case file as given, TOML; empty if there was none"),
    Entry("/case/resolved", TEXT, "the case with all defaults, JSON; sections and keys as in the case file"),
    Entry("/case/members", GROUP, "temperature histories of the members of a truss, linear between the times",
          required=False),
    Entry("/case/members/names", _array("text", "members"), "links and revolutes", required=False),
    Entry("/case/members/time_s", _array("float64", "times"), "from 0", required=False),
    Entry("/case/members/temperature_change_K", _array("float64", "times", "members"),
          "from the reference temperature", required=False),
    Entry("/provenance", GROUP, "versions that computed it, without machine and date"),
    Entry("/provenance@statejump_version", TEXT, "version of this project"),
    Entry("/provenance@git_commit", TEXT, "commit it was built from, -dirty if changed; empty if not known"),
    Entry("/provenance@python_version", TEXT, "version of Python"),
    Entry("/provenance@numpy_version", TEXT, "version of numpy"),
    Entry("/provenance@h5py_version", TEXT, "version of h5py"),
    Entry("/provenance@hdf5_version", TEXT, "version of the HDF5 library"),
    Entry("/provenance@yade_version", TEXT, "version of YADE; only with a DEM run", required=False),
    Entry("/provenance@threads", WHOLE, "OpenMP threads of the DEM run; only with one", required=False),
    Entry("/provenance@seed", WHOLE, "seed of the case's random numbers; only for kinds that draw some",
          required=False),
    Entry("/names", GROUP, "names of the items along the second axis of columns"),
    Entry("/names/{name}", _array("text", "items"), "a list of names; columns refer to it with their attribute items",
          required=False),
    Entry("/scene", TEXT, "JSON: parts, forces, and the columns that move them"),
    Entry("/meshes", GROUP, "surfaces that parts of type mesh refer to", required=False),
    Entry("/meshes/{name}", GROUP, "one surface", required=False),
    Entry("/meshes/{name}/vertices_m", _array("float64", "vertices", "3"), "in the part's own frame", required=False),
    Entry("/meshes/{name}/triangles", _array("int64", "triangles", "3"), "indices into vertices_m", required=False),
    Entry("/warnings", _array("text", "sentences"), "limits of the models that the run reached"),
    Entry("/models", GROUP, "one group per model that was run"),
    Entry("/models/{model}", GROUP, "a run", required=False),
    Entry("/models/{model}/history", GROUP, "columns over time"),
    Entry("/models/{model}/history/time_s", _array("float64", "samples"), "times of all columns of this model"),
    Entry("/models/{model}/history/temperature_change_K", _array("float64", "samples"),
          "program of the temperature change",
          required=False),
    Entry("/models/{model}/history/{name}", COLUMN, "a column; the same names as in the CSV files", required=False),
    Entry("/models/{model}/energy", GROUP, "energies, dissipated and supplied energies"),
    Entry("/models/{model}/energy/{name}", COLUMN, "a column [J]", required=False),
    Entry("/models/{model}/links", GROUP, "columns of every link"),
    Entry("/models/{model}/links/axial_force_N", _array("float64", "samples", "links"),
          "compression positive", required=False),
    Entry("/models/{model}/links/thermal_strain", _array("float64", "samples", "links"),
          "alpha times temperature change",
          required=False),
    Entry("/models/{model}/links/{name}", COLUMN, "a further column", required=False),
    Entry("/models/{model}/contacts", GROUP, "columns of every contact"),
    Entry("/models/{model}/contacts/state", _array("uint8", "samples", "contacts"),
          "0 separated, 1 stick, 2 slip, 3 at_stop (attribute labels)", required=False),
    Entry("/models/{model}/contacts/gap_m", _array("float64", "samples", "contacts"),
          "negative: penetration", required=False),
    Entry("/models/{model}/contacts/point_m", _array("float64", "samples", "contacts", "3"), "where the force acts",
          required=False),
    Entry("/models/{model}/contacts/normal_force_N", _array("float64", "samples", "contacts", "3"),
          "on the part that the scene's contact names in `on`", required=False),
    Entry("/models/{model}/contacts/tangential_force_N", _array("float64", "samples", "contacts", "3"),
          "on the same part",
          required=False),
    Entry("/models/{model}/contacts/{name}", COLUMN, "a further column", required=False),
    Entry("/models/{model}/events", GROUP, "events in order of time; five data sets of one length"),
    Entry("/models/{model}/events/kind", _array("text", "events"), "first_contact, first_slip, stop_reached, ..."),
    Entry("/models/{model}/events/time_s", _array("float64", "events"), "when"),
    Entry("/models/{model}/events/temperature_change_K", _array("float64", "events"), "at which temperature change"),
    Entry("/models/{model}/events/joint", _array("text", "events"), "name of the contact or joint; empty: none"),
    Entry("/models/{model}/events/time_uncertainty_s", _array("float64", "events"),
          "0: located by the model; else half the distance of the samples between which it lies"),
    Entry("/models/{model}/summary", GROUP, "numbers that sum up the run"),
    Entry("/models/{model}/summary/{name}", NUMBER, "one number; NaN: it did not happen", required=False),
    Entry("/comparison", GROUP, "the two models beside each other; only in files of compare", required=False),
    Entry("/comparison@passed", BOOL, "true if all rows passed", required=False),
    Entry("/comparison/quantity", _array("text", "rows"), "compared quantity", required=False),
    Entry("/comparison/unit", _array("text", "rows"), "unit of the row", required=False),
    Entry("/comparison/closed_form", _array("float64", "rows"),
          "value of a closed form; NaN: the row has none", required=False),
    Entry("/comparison/compared", _array("text", "rows"),
          "whose values a row compares, two of closed_form, reduced, dem, fe; missing: reduced dem in all",
          required=False),
    Entry("/comparison/reduced", _array("float64", "rows"),
          "value of the reduced model; NaN: it has none", required=False),
    Entry("/comparison/dem", _array("float64", "rows"), "value of the DEM; NaN: it has none", required=False),
    Entry("/comparison/fe", _array("float64", "rows"),
          "value of finite elements; NaN: the row has none", required=False),
    Entry("/comparison/difference", _array("float64", "rows"), "DEM less reduced; NaN: one is missing", required=False),
    Entry("/comparison/tolerance", _array("float64", "rows"), "allowed size of the difference", required=False),
    Entry("/comparison/passed", _array("bool", "rows"), "whether the difference is within it", required=False),
    Entry("/comparison/reasons", _array("text", "sentences"), "why a tolerance may have been missed, and what to set",
          required=False),
    Entry("/answers", GROUP, "design questions of a truss; only in files of truss answers", required=False),
    Entry("/answers@output", TEXT, "output whose jump the joints share: node:NAME, rms or tilt", required=False),
    Entry("/answers@text", TEXT, "the same as text", required=False),
    Entry("/answers@unit", TEXT, "its unit", required=False),
    Entry("/answers@verdict", TEXT, "no jump, one cycle, shakedown, ratcheting, not settled or not resolved",
          required=False),
    Entry("/answers@verdict_text", TEXT, "the same as text", required=False),
    Entry("/answers/notes", _array("text", "sentences"), "results that are missing or limited", required=False),
    Entry("/answers/summary", GROUP, "numbers that sum up the answers: jump, sum_of_contributions, ...",
          required=False),
    Entry("/answers/summary/{name}", NUMBER, "one number", required=False),
    Entry("/answers/{name}", GROUP, "a table", required=False),
    Entry("/answers/{name}/{name}", _array("text int64 float64", "rows"),
          "a column of it; NaN: there is no such number",
          required=False),
)

# Numbers of /answers/summary that are all present or all absent.
SUM_OF_CONTRIBUTIONS = ("sum_of_contributions", "sum_error_relative")
# Tables of /answers: meaning of a row, and the columns in the order of the CSV file.
_JUMP = ("jump_x_m", "jump_y_m", "jump_z_m", "jump_m")
TABLES: dict[str, tuple[str, tuple[str, ...]]] = {
    "cycles": ("a cycle: largest motion of a node over it, heat of friction",
               ("cycle", "largest_jump_m", "dissipation_J")),
    "node_jumps": ("a node after a cycle, against the start", ("node", "cycle", *_JUMP)),
    "joint_jumps": ("a joint after a cycle: jump of its slide or eccentricity, heat of friction",
                    ("joint", "kind", "cycle", *_JUMP, "dissipation_of_cycle_J", "dissipation_J")),
    "surface": ("the reflecting surface in a state against its best fit; changes since the start",
                ("state", "temperature_change_K", "rms_error_m", "rms_of_change_m", "tilt_change_rad", "focal_length_m",
                 "focal_shift_m", "depth_change_m")),
    "contributions": ("a joint, the one with the largest contribution first",
                      ("rank", "joint", "kind", "contribution", "share")),
    "sensitivities": ("a parameter; elasticity: relative change of the jump per relative change of it",
                      ("parameter", "items", "value", "elasticity", "elasticity_half_step", "jump_change_per_unit",
                       "verdict")),
}

# Attributes of all data sets of numbers.
ATTRIBUTES = {
    "unit": "unit of the values, - for none; all data sets of numbers have it",
    "items": "name of the list below /names that names the second axis",
    "labels": "the values are indices into this list of texts",
    "note": "method of the values, if the name does not state it",
}


# Text columns of these tables; all others are numbers.
TEXTS = frozenset({"node", "joint", "kind", "state", "parameter", "verdict"})
ALWAYS = ("cycles", "node_jumps", "joint_jumps")  # tables that all answers have
WITHOUT_GAPS = (*ALWAYS, "contributions")  # tables without missing numbers


def entry_of(path: str) -> Entry | None:
    """Return the most specific entry for a path in a file."""
    found = [entry for entry in ENTRIES if entry.matches(path)]
    return min(found, key=lambda entry: entry.path.count("{name}")) if found else None


def markdown() -> str:
    """Return the layout as the tables of docs/reference/result_file.md."""
    lines = ["| place | type [shape] | meaning |", "|---|---|---|"]
    for entry in ENTRIES:
        always = "" if entry.required else " (optional)"
        lines.append(f"| `{entry.path}` | {entry.form} | {entry.meaning}{always} |")
    lines += ["", "| attribute | meaning |", "|---|---|"]
    lines += [f"| `{name}` | {meaning} |" for name, meaning in ATTRIBUTES.items()]
    lines += ["", "| table below `/answers` | a row is | columns |", "|---|---|---|"]
    lines += [f"| `{name}` | {row} | {', '.join(f'`{column}`' for column in columns)} |"
              for name, (row, columns) in TABLES.items()]
    return "\n".join(lines) + "\n"
