# SPDX-License-Identifier: GPL-3.0-or-later
"""Codes of errors, and for each code the parts of the sentence that all its errors share.

A new error needs one entry here. Raise it with ``code="..."`` and one argument for each name in braces: the arguments
become ``StatejumpError.details``, and the sentence is rendered from them. Codes are part of the public interface and do
not change; sentences may change. studies/docs/make_mistakes.py lists the codes in docs/reference/mistakes.md.
"""
from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Code:
    """Parts of the sentence ``WHAT[ BESIDE][: CAUSE][; REMEDY]``, as templates. A part that each error gives is "".

    :param text: description of the problem, for a code whose errors give the whole sentence themselves
    :param further: names of details that programs can read but that the sentence does not contain
    """

    what: str = ""
    beside: str = ""
    cause: str = ""
    remedy: str = ""
    text: str = ""
    further: tuple[str, ...] = ()


CODES: dict[str, Code] = {
    # Codes of the classes of errors, where an error has no code of its own.
    "bad_input": Code(text="bad input"),
    "out_of_range": Code(text="a number is outside of the range of its key"),
    "not_allowed": Code(text="the value of a key is not allowed"),
    "missing_key": Code(text="a key or a section is missing"),
    "unknown_key": Code(text="there is no such key or section"),
    "unreadable": Code(text="a file cannot be read, or is not what it should be"),
    "failed_run": Code(text="the run could not be finished"),
    "not_written": Code(text="a file or a folder cannot be written"),
    "tolerance_missed": Code(what="tolerance missed"),
    "interrupted": Code(what="interrupted; nothing was written"),
    "usage": Code(text="the command has no such option or argument"),
    "internal": Code(text="a fault of the program itself"),
    # The reader of case files
    "columns_not_of_one_length": Code(cause="all columns must have {rows} rows"),
    "control_characters": Code(cause="must have no control characters"),
    "empty_string": Code(cause="must be a text in quotes that is not empty"),
    "key_renamed": Code(remedy="it is {now} now"),
    "deprecated_key_duplicated": Code(cause="the case has {new_key} as well", remedy="leave {old_key} out"),
    "misspelt_key": Code(remedy="did you mean {meant}?"),
    "misspelt_name": Code(cause="must be {known}", remedy="did you mean {meant!r}?"),
    "no_folder_name": Code(cause="must consist of letters, digits, '_' and '-'"),
    "no_item_fits": Code(cause="no {table} has a name that fits {pattern!r}; their names are {known}"),
    "case_file_not_found": Code(what="no such {of} file"),
    "no_such_key": Code(cause="known are {known}"),
    "not_table_list": Code(cause="must be one or more sections [[{table}]]"),
    "not_section": Code(cause="must be a section [{wanted}]"),
    "not_boolean": Code(cause="must be true or false"),
    "not_from_file": Code(text="the key holds what no case file can state"),
    "not_number_list": Code(cause="must be a list of numbers [{unit}]"),
    "not_string_list": Code(cause="must be a list of texts in quotes"),
    "not_toml": Code(what="not TOML"),
    "not_toml_at_line": Code(what="not TOML, line {line}"),
    "number_not_finite": Code(cause="must be finite, {range}"),
    "several_values": Code(what="{path} has several values"),
    "toml_not_utf8": Code(what="not TOML", cause="the file is not UTF-8 text"),
    "toml_too_deep": Code(what="not TOML", cause="tables or lists stand too deeply in each other"),
    "unknown_name": Code(cause="must be {known}"),
    "wrong_list_length": Code(cause="must be a list of {length} numbers [{unit}]"),
    "wrong_type": Code(cause="must be {type}, {range}"),
    "wrong_value": Code(text="the value of a key is wrong"),
    "not_in_build": Code(what="engine", cause="{name} is not in this build", remedy="run make build"),
    # Several keys together
    "below_minimum": Code(cause="must be at least {least}"),
    "clearance_below_precision": Code(
        cause="too small beside {radius_key} = {radius_m!r} [m], the radii come out equal",
    ),
    "clearance_closes": Code(
        cause=(
            "the expansion of {inner} and {outer} closes it at a temperature change of {at_K:g} K, it must stay "
            "above 0 [m] within the program"
        ),
    ),
    "conflicting_key": Code(beside="with {other}"),
    "not_positive": Code(cause="must be a finite number above 0 [{unit}]"),
    "play_without_friction": Code(cause="needs friction, in series with which it is: give {needed_keys}"),
    # Cases, tables and files
    "folder_in_use": Code(what="is in use", cause="another run is at work in it"),
    "folder_not_empty": Code(cause="the folder has other files", remedy="name a new folder"),
    "no_display": Code(
        what="YADE's 3-D view cannot be opened",
        remedy="use a terminal on a desktop, or set DISPLAY",
    ),
    "no_space_left": Code(
        what="no space left",
        cause="the results need about {needed}, the file system has {free} left",
    ),
    "unknown_ignored_column": Code(cause="the table has no such column"),
    "yade_view_ended": Code(what="YADE ended with status {status}"),
    "built_without_yade": Code(
        what="YADE is missing",
        cause="this statejump was built without it",
        remedy="for 'dem' and 'compare' build with 'make demo' on Debian 12 or 13",
    ),
    "read_failed": Code(what="cannot be read"),
    "cell_not_boolean": Code(what="line {line}, column {column}", cause="{cell} is not true or false"),
    "cell_of_other_length": Code(
        what="line {line}, column {column}",
        cause="{numbers} numbers, other rows have {width}",
    ),
    "cell_too_long": Code(what="line {line}, column {column}", cause="{entries} entries, a cell has {most} at most"),
    "bad_cell": Code(what="line {line}, column {column}", further=("reason", "cell")),
    "column_no_numbers": Code(beside="as a column", cause="every row needs a number there"),
    "column_not_in_tables": Code(what="column {column}", cause="a table cannot have this key"),
    "column_of_other_unit": Code(
        what="column {column!r}", cause="{unit!r} is not a unit {quantity}", further=("accepted",),
    ),
    "column_without_name": Code(what="line {line}: column {column} has no name"),
    "column_without_unit": Code(what="column {column!r}", cause="it names no unit", further=("accepted",)),
    "column_without_unit_or_times": Code(
        what="column {column}", cause="it names no unit and has no ISO times", further=("accepted",),
    ),
    "columns_of_one_key": Code(
        what="column {column!r} is not allowed beside {other!r}",
        cause="both are {key_of_both}",
    ),
    "columns_of_one_name": Code(what="two columns are called {column}"),
    "columns_of_other_length": Code(what="columns differ in length"),
    "columns_of_other_units": Code(what="columns {column} and {other}", cause="they have different units"),
    "csv_not_utf8": Code(what="not CSV", cause="the file is not UTF-8 text"),
    "program_not_periodic": Code(cause="what is repeated must end where it begins, and {why}"),
    "data_set_missing": Code(what="must have the data set {data_set}", cause="numbers along {axes} axes"),
    "data_set_not_of_numbers": Code(what="{data_set} must be of numbers"),
    "data_set_not_of_texts": Code(what="{data_set} must be of texts"),
    "data_set_not_utf8": Code(what="{data_set} has texts that are not UTF-8"),
    "data_set_of_wrong_shape": Code(what="{data_set} must be a data set of {form}"),
    "data_set_rows_too_long": Code(what="{data_set} has rows of {length}", cause="at most {most} are read"),
    "decimal_comma_and_point": Code(
        what="line {line}, column {column}",
        cause="{cell} has a decimal comma, {other} in line {other_line} a point",
        remedy="write one decimal mark",
    ),
    "decimal_comma_or_thousands": Code(
        what="line {line}, column {column}",
        cause="{cell} may be a decimal number or one of thousands",
        remedy="write decimal points",
    ),
    "dem_failed": Code(what="the DEM run failed", further=("reason", "part", "quantity")),
    "dem_killed": Code(what="the DEM run was killed by signal {signal}; nothing was written"),
    "dem_without_result": Code(what="the DEM run left no complete result"),
    "expansion_coefficients": Code(
        cause="must be {rows} coefficients [1/K], one for every temperature change, not all of them 0",
    ),
    "expansion_shape": Code(
        cause="must be 'triangle' or 'table' where an expansion follows the temperature, which needs straight pieces",
    ),
    "expansion_temperatures": Code(
        cause="must be at least two temperature changes [K] that rise, 0 among or between them",
    ),
    "expansion_too_narrow": Code(
        cause="it must hold the temperature change of {reached_K:g} K that the program reaches",
    ),
    "fewer_than_two_times": Code(what="has fewer than two times"),
    "file_too_large_to_read": Code(what="cannot be read", cause="it is larger than {largest}{why}"),
    "first_column_no_times": Code(
        what="line 1: the first column is {column}",
        remedy="accepted are time_s, time [h], or time with ISO times",
        further=("reason",),
    ),
    "first_column_without_name": Code(what="line {line}: column 1 has no name", cause="and does not count the rows"),
    "interrupted_before_first_sample": Code(what="interrupted before the first sample; nothing was written"),
    "interrupted_before_sample": Code(what="interrupted before a whole sample; nothing was written"),
    "last_time_too_late": Code(what="its last time is too late", cause="at most {latest_s:g} s are allowed"),
    "lead_in_missing": Code(
        cause=(
            "{table} begins {away_K:g} K away from the stress-free temperature (column {column!r}), and it must "
            "be said how long the way there takes"
        ),
    ),
    "link_ends_incomplete": Code(
        what="has the column {column} {relation} {other}",
        cause="a link has one temperature, or one at either end",
    ),
    "link_without_length": Code(cause="the link has no length left at a temperature change of {at_K:g} K"),
    "member_without_name": Code(what="members has a name that is empty or not printable"),
    "members_missing": Code(what="must have the data set members", cause="their names, texts along one axis"),
    "members_file_not_in_text": Code(beside="in the text of a case file", remedy="save() writes a file beside it"),
    "members_not_utf8": Code(what="members has texts that are not UTF-8"),
    "misspelt_column": Code(what="has no column {column}_K or {column}_degC", remedy="did you mean {meant!r}?"),
    "name_with_blank": Code(cause="names in a list of a table must have no blanks"),
    "table_without_header": Code(
        what="line {line} names no columns",
        cause="it holds numbers only",
        remedy="write a line of names with units above it",
    ),
    "state_jump_undefined": Code(cause="{output} needs a state jump, and {why}"),
    "no_column": Code(what="line 1: there is no column"),
    "no_iso_time": Code(what="line {line}, column {column!r}", remedy="write {accepted}", further=("reason",)),
    "no_result_format": Code(what="not a result file", cause="it does not begin with {begin!r}"),
    "no_row": Code(what="has no row below its header"),
    "no_samples": Code(what="holds no samples"),
    "column_not_found": Code(what="has no column {column}_K or {column}_degC", cause="its columns are {known}"),
    "result_file_not_found": Code(what="no such result file"),
    "table_file_not_found": Code(what="no such file of tables"),
    "temperature_file_not_found": Code(what="no such file of temperatures"),
    "no_temperature_column": Code(what="line 1: there is no column of temperatures"),
    "not_string": Code(cause="must be a text in quotes"),
    "no_times": Code(cause="must be a time or a list of times [s]"),
    "yade_missing": Code(
        what="YADE is missing",
        cause="no command {command!r} found",
        remedy="install Debian's package 'yade' or set STATEJUMP_YADE to the command",
    ),
    "not_csv": Code(what="not CSV"),
    "not_finite": Code(cause="must be a finite number"),
    "not_hdf5": Code(what="cannot be read", cause="it is not HDF5"),
    "one_run_of_a_model": Code(
        beside="for two runs of one model",
        cause="a result file holds one run of a model; save both runs",
    ),
    "key_of_case_file": Code(
        cause=(
            "only where a case file names a table_file or members_file, or the name of one is given to load() or "
            "changed()"
        ),
    ),
    "requires_table_shape": Code(cause="only with {in_section}shape = 'table'"),
    "result_part_missing": Code(what="{group}/{name} is missing"),
    "period_beside_table": Code(
        cause="the table lasts {lasts:g} s, and its own times are the times",
        remedy="leave {key_to_leave_out} out",
    ),
    "reference_missing": Code(cause="{table} has temperatures in °C, and the stress-free temperature must be stated"),
    "result_checksum": Code(what="damaged", cause="its checksum is that of other contents: it was cut off or altered"),
    "result_claims_too_much": Code(what="damaged", cause="{object} claims to hold more than the file does"),
    "result_external": Code(what="damaged", cause="{object} has its numbers in another file"),
    "result_link": Code(what="damaged", cause="{object} is a link out of its place"),
    "result_newer": Code(what="version {found} is newer than {newest}, the newest that this statejump reads"),
    "result_no_object": Code(what="damaged", cause="{object} is neither a group nor a data set of its own"),
    "result_not_utf8": Code(what="damaged", cause="{object} is not UTF-8"),
    "result_without_checksum": Code(
        what="not a result file",
        cause="HDF5, but without the checksum that this version writes",
    ),
    "results_of_other_case": Code(
        what="holds results of another case",
        cause="{other} has the same case.name",
        remedy="change case.name, choose another folder with --results, or replace them with --force",
    ),
    "return_too_late": Code(
        cause="the table lasts {lasts:g} s, and the return to the reference temperature ends after it",
        remedy="leave {key_to_leave_out} out",
    ),
    "row_of_other_length": Code(
        what="line {line} has {cells} cells", cause="the header has {width}", further=("decimal_commas",),
    ),
    "truncated_samples": Code(what="ends within a row"),
    "samples_without_header": Code(what="does not begin with the names of columns"),
    "several_columns": Code(cause="{table} has the columns {columns}"),
    "suffix_unknown": Code(cause="must end with {suffixes}"),
    "table_not_periodic": Code(
        cause=(
            "{table} ends {away_K:g} K away from the stress-free temperature (column {column!r}), and what is "
            "repeated must end where it begins"
        ),
    ),
    "table_ends": Code(cause="must start at 0 [K] and, with several cycles and without a return, end at 0 [K]"),
    "table_length": Code(cause="must be {times} values, one per time, not {values}"),
    "table_times": Code(cause="must be at least two times [s] that start at 0 and rise"),
    "table_times_missing": Code(cause="a list of times [s] is needed for a table"),
    "table_and_section": Code(cause="the case has [[{table}]] as well", remedy="leave one of them out"),
    "table_values_missing": Code(cause="one value [K] per time is needed"),
    "target_not_file": Code(what="cannot be written", cause="there is something else than a file"),
    "vtk_missing": Code(
        what="VTK is not installed",
        remedy="install Debian's package 'python3-vtk9'",
    ),
    "wrong_suffix": Code(cause="the file must end with {suffixes}"),
    "temperature_column_without_unit": Code(
        what="line 1: column {column}", remedy="accepted are {accepted}", further=("unit",),
    ),
    "bad_temperature": Code(what="column {column} at {at_s:g} s", further=("reason", "value_K")),
    "temperatures_missing": Code(what="must have one of the data sets {data_sets}"),
    "temperatures_of_other_shape": Code(
        what="{data_set} is {rows} x {columns}",
        cause="there are {times} times and {members} members",
    ),
    "time_not_increasing": Code(what="time_s[{index}] = {at_s:g}", cause="times must be finite and rise"),
    "times_not_increasing": Code(
        what="line {line}: {column} = {time}",
        cause="times must rise, and {before} is before it",
    ),
    "times_too_close": Code(
        what="times {first_s:g} and {second_s:g}",
        cause="they cannot be told apart within {whole_s:g} s",
    ),
    "yade_ended": Code(what="YADE ended with status {status} before the run was finished"),
    "yade_not_started": Code(what="YADE cannot be started: {command}"),
    # Results
    "cases_differ": Code(what="not comparable", cause="the cases differ: {key_that_differs}{more}"),
    "damaged": Code(what="damaged", further=("object",)),
    "drawing_not_finite": Code(what="cannot be drawn", cause="places or forces are not finite, or too large"),
    "durations_differ": Code(what="not comparable", cause="the runs last {first_s:g} s and {second_s:g} s"),
    "result_items_differ": Code(what="not comparable", cause="the files name other links or contacts"),
    "kinds_differ": Code(what="not comparable", cause="kinds {first} and {second}"),
    "layout_newer": Code(what="layout version {found} is newer than {newest}, the newest that this statejump reads"),
    "model_unknown_in_file": Code(what="/models/{model} is not a model", cause="must be {models}"),
    "result_without_model": Code(what="/models has no model"),
    "result_without_run": Code(what="not comparable", cause="a file holds no run"),
    "object_missing": Code(what="{object}{at}{attribute} is missing"),
    "objects_too_deep": Code(what="damaged", cause="objects stand too deeply in each other"),
    "openpyxl_missing": Code(
        what="openpyxl is missing",
        remedy="install Debian's package 'python3-openpyxl', or take --format csv",
    ),
    "page_not_finite": Code(what="cannot be drawn", cause="{entry} is not finite"),
    "page_only_of_truss": Code(
        cause="a page of a case that is not solved is for 'truss'",
        remedy="'statejump compare {source}' solves it",
    ),
    "page_script_missing": Code(
        what="the page's script is missing ({script})",
        remedy="`make build` builds it; it needs Node and, once, the npm registry",
    ),
    "result_other_format": Code(what="not a result file", cause="HDF5, but its attribute format is not {wanted!r}"),
    "run_not_complete": Code(what="not comparable", cause="a run was interrupted and is not complete"),
    "runs_of_other_cases": Code(what="not comparable", cause="the runs are of other cases: {cases}"),
    "scene_damaged": Code(what="damaged", cause="/scene: {why}"),
    "scene_reference": Code(what="scene", cause="{reference} refers to nothing in the file: {why}"),
    "table_too_large": Code(
        what="is too large for a sheet",
        cause="{rows:,} rows and {columns:,} columns, a sheet has {most_rows:,} and {most_columns:,}",
        remedy="take --format csv",
    ),
    # Campaigns
    "also_not_list": Code(cause="must be a list of keys that get the same value"),
    "campaign_interrupted": Code(
        what=(
            "interrupted; {finished:,} of {samples:,} samples are kept in {path}, the same command goes on with "
            "the others"
        ),
    ),
    "write_failed": Code(what="cannot be written"),
    "grid_count_out_of_range": Code(cause="must be a whole number, between 2 and {most_samples}"),
    "deviation_missing": Code(cause="either it or relative is needed, above 0"),
    "deviation_not_positive": Code(cause="times the mean it is {deviation:g}, no number above 0"),
    "distribution_not_dict": Code(
        cause='must be a dict, as {{"distribution": "normal", "relative": 0.1}}; sweep takes values',
    ),
    "distribution_without_limits": Code(cause="a {distribution} distribution has no limits"),
    "grid_too_large": Code(cause="the grid has {points} points, must be at most {most_samples}"),
    "item_not_in_case": Code(cause="the case has no {table} {name!r}"),
    "items_share_values": Code(cause="items of {main!r} share their values with their own keys"),
    "journal_damaged": Code(
        what="line {line} is damaged",
        cause="its checksum is that of other contents",
        remedy="--restart drops what is there",
    ),
    "journal_of_other_campaign": Code(
        what=(
            "belongs to another campaign (the campaign, its case or statejump has changed since); --restart drops "
            "what is there, another campaign.name keeps it"
        ),
    ),
    "key_missing": Code(text="a [[vary]] names no key"),
    "key_not_in_kind": Code(beside="in a case of kind {kind!r}"),
    "key_of_other_campaign": Code(
        beside="in a campaign of 'statejump {command}'",
        cause="it is for 'statejump {other}'",
    ),
    "limits_missing": Code(cause="a truncated_normal distribution has low or high or both"),
    "log_spacing_not_positive": Code(cause="must, as stop, be above 0 for a log spacing"),
    "lognormal_mean": Code(cause="must be above 0 for a lognormal distribution"),
    "zero_mean": Code(cause="the mean is 0"),
    "missing_distribution": Code(cause="must be {known}"),
    "mean_not_in_case": Code(cause="the case gives no {mean_of}"),
    "model_not_of_kind": Code(cause="a campaign of {kind!r} has {models}"),
    "no_campaign_of_kind": Code(cause="no campaign runs {kind!r}"),
    "vary_without_key": Code(cause="at least one key is needed"),
    "not_list_of_numbers": Code(cause="must be a list of numbers"),
    "section_not_in_case": Code(cause="the case has no [[{table}]]"),
    "no_yade_batch_of_kind": Code(cause="no such campaign runs {kind!r}"),
    "key_not_numeric": Code(cause="it is not a number"),
    "not_above_low": Code(cause="must be above low = {low!r}"),
    "not_finite_above": Code(cause="must be a finite number above {least:g}"),
    "empty_truncated_distribution": Code(
        cause="practically nothing of the normal distribution is left between the limits",
    ),
    "campaign_without_vary": Code(cause="at least one table says what varies"),
    "sweep_with_distribution": Code(beside="in a sweep", cause="only 'statejump montecarlo' draws samples"),
    # Rare events
    "nlopt_missing": Code(
        what="the package nlopt is missing", remedy="install it with 'apt install python3-nlopt', or use 'slsqp'",
    ),
    "design_axis_and_position": Code(cause="an axis belongs to node.*.position_m, and to no other key"),
    "design_axis_of_plane": Code(cause="the positions of this truss have two components"),
    "design_bad_formula": Code(
        cause="{reason}", remedy="use numbers, + - * / **, sum(), sqrt(), exp(), log() and the names {names}"),
    "design_bad_grid": Code(cause="must be a list of numbers above 0"),
    "design_interrupted": Code(what="interrupted; the best design so far is in {path}"),
    "design_key_twice": Code(cause="variable {other!r} changes this number too"),
    "design_log_not_positive": Code(cause="a factor on a log scale must be above 0", remedy="set scale = 'linear'"),
    "design_no_guarantee": Code(
        what="the bound of {output} is not guaranteed, its margin is not derived",
        remedy="see 'statejump bounds' for the reason, or use 'linear_bound'"),
    "design_no_keys": Code(cause="must name at least one key"),
    "design_no_node": Code(cause="no node that moves has such a name"),
    "design_no_value": Code(cause="the case has no value other than 0 that a factor could change"),
    "design_output_of_bound": Code(cause="an output belongs to bounds, and to no other quantity"),
    "design_too_many": Code(cause="{count} variables are more than the {most} allowed"),
    "design_without_jump": Code(cause="the program does not return to its initial temperature"),
    "openturns_missing": Code(
        what="OpenTURNS", cause="the library is not installed", remedy="install the package python3-openturns",
    ),
    "rare_interrupted": Code(
        what="interrupted; {finished:,} runs are kept in {path}, the same command goes on with the others"),
    "rare_needs_limit": Code(cause="exactly one of {options} is needed"),
    "rare_needs_reduced": Code(cause="rare events need the reduced model", remedy="set model = 'reduced'"),
    "rare_run_failed": Code(
        what="{outcome}", cause="a run of the search for the design point failed: {error}",
        remedy="use {remedy_option}",
    ),
    "rare_no_value": Code(
        what="{outcome}", cause="it has no value in a run of the search for the design point",
        remedy="use {remedy_option}",
    ),
    "rare_no_design_point": Code(
        what="{outcome}", cause="FORM found no design point within {runs} runs: {error}", remedy="use {remedy_option}",
    ),
    "rare_frequent": Code(
        what="{outcome}", cause="the unchanged case is beyond the limit already, the event is not rare",
        remedy="use 'statejump montecarlo'",
    ),
    "rare_not_unique": Code(
        what="{outcome}", cause="FORM is invalid, the opposite point of the design point is beyond the limit too",
        remedy="use {remedy_option}",
    ),
    "rare_kink": Code(
        what="{outcome}",
        cause="FORM is invalid at a kink, the gradients on both sides of the design point differ by {percent:.0f} %",
        remedy="use {remedy_option}",
    ),
    "rare_tent": Code(
        what="{outcome}",
        cause="FORM is invalid at a tent, {deviations:.2g} standard deviations beyond the design point the outcome "
              "is within the limit again",
        remedy="use {remedy_option}",
    ),
    "rare_not_sampled": Code(
        what="{outcome}",
        cause="the coefficient of variation of importance sampling is {variation:.2g} after {runs} runs",
        remedy="use {remedy_option} or more runs",
    ),
    "rare_not_reached": Code(
        what="{outcome}", cause="no sample of {runs} runs is beyond the limit", remedy="use more runs",
    ),
    "rare_failed_samples": Code(
        what="{outcome}", cause="{failed} of {runs} runs failed, the first with: {error}",
        remedy="narrow the distributions",
    ),
    "output_axis": Code(cause="the axis must be one of {known}"),
    "bad_output_name": Code(cause="must be HOW:COLUMN[ITEM].AXIS, as 'jump:displacement_m[P].x'"),
    "output_how_unknown": Code(cause="HOW must be one of {hows}"),
    "output_item_not_chosen": Code(cause="{column} is one of each of the {items}: which one?"),
    "output_misspelt": Code(cause="did you mean {meant}?"),
    "output_not_vector": Code(cause="{column} is no vector"),
    "output_without_item": Code(cause="there are no {items}"),
    "output_without_bounds": Code(text="this kind of case has no bounds"),
    "output_bound_not_chosen": Code(cause="of which output is the bound, as in 'bound:spread_m[node:C.y]'?"),
    "output_without_surface": Code(text="the run has no surface of which the output is"),
    "output_item_undefined": Code(cause="there is no such {what_it_is}; there are {known}"),
    "output_without_items": Code(cause="{column} has no items"),
    "output_without_jump": Code(
        cause="the temperature comes back where it began {times} times, 2 are needed",
        remedy="set thermal.cycles",
    ),
    "path_not_string": Code(cause="must be a text such as 'joint.friction_coefficient'"),
    "range_missing": Code(cause="either values, or start, stop and count are needed"),
    "scheduler_address": Code(text="the option names no address of a running scheduler"),
    "scheduler_connection_lost": Code(what="the connection to the dask scheduler was lost ({problem}); {advice}"),
    "scheduler_lost_workers": Code(what="the dask scheduler has had no workers for {patience:g} s; {advice}"),
    "scheduler_not_encrypted": Code(what="is not encrypted", cause="Dask's configuration has require-encryption"),
    "scheduler_not_reached": Code(what="cannot be reached within {connect_s} s"),
    "scheduler_of_other_version": Code(what="has a worker {worker} with statejump {version}, here it is {here}"),
    "scheduler_without_certificates": Code(what="needs certificates", remedy="docs/security.md shows how"),
    "scheduler_without_statejump": Code(
        what="has workers that cannot import statejump {here}, start them with PYTHONPATH set",
    ),
    "scheduler_without_workers": Code(what="has no workers after {workers_s} s"),
    "duplicate": Code(cause="it is there twice"),
    "uniform_limits": Code(cause="a uniform distribution has low and high, or relative"),
    "duplicate_value": Code(cause="a value is there twice"),
    "duplicate_vary": Code(cause="it varies already"),
    "integer_not_random": Code(cause="it is a whole number, only 'statejump sweep' varies it"),
    # Commands
    "conflicts_with_case": Code(beside="beside a case", cause="its section [reflector] says it"),
    "conflicts_with_campaign_file": Code(beside="with a campaign file", cause="it says that itself"),
    "conflicts_with_scheduler": Code(beside="with --scheduler", cause="that cluster has its own"),
    "every_sample_failed": Code(what="every sample failed, the first one"),
    "exists_already": Code(cause="exists already", remedy="--force overwrites it"),
    "bad_fixed_option": Code(cause="must be NODE=DIRECTIONS, of the letters x, y and z"),
    "bad_joint_option": Code(cause="must be KEY=VALUE,KEY=VALUE, every key once"),
    "exact_path_without_ensemble": Code(cause="case {name_of_case} has one exact path, no ensemble is run"),
    "output_folder_missing": Code(what="cannot be written", cause="there is no folder {folder}"),
    "no_length_column": Code(cause="no column of it is a length [m]"),
    "result_file_missing": Code(
        what="no result file",
        cause="no *{suffix} in this folder",
        remedy="'statejump compare CASE' writes one",
    ),
    "suffix_missing": Code(what="has no suffix to leave out", remedy="choose a folder with --to"),
    "one_jump_only": Code(cause="a case of kind {kind!r} has one jump, and all that governs it is studied"),
    "requires_members_file": Code(cause="only with --members-file"),
    "samples_and_column": Code(cause="--samples and --column go together"),
    "samples_interrupted": Code(what="interrupted; the {samples} samples so far are in {kept}"),
    "bad_shadow_option": Code(cause="must be BEGIN:END in seconds, as 1800:3900"),
    "standard_output_not_written": Code(what="standard output cannot be written"),
    "units_in_columns": Code(cause="columns of tables name their units"),
    "units_given_twice": Code(cause="--units {system} says it already"),
    "vary_file_missing": Code(cause="a case needs a file that says what varies"),
    "working_folder_gone": Code(what="the folder where the command was started does not exist any more"),
    "wrong_number_of_files": Code(
        what="{files} file(s) given",
        cause="'statejump compare' takes a case file or two result files",
        remedy="what is in one shows 'statejump info'",
    ),
    # Kinds of cases
    "trace_of_motion": Code(
        what="a motion has no trace",
        cause="a trace records the iterations of the quasi-static solver",
        remedy="leave out 'dynamic' or 'trace'",
    ),
    "command_not_for_kind": Code(cause="'statejump {command}' is for {kinds}"),
    "studies_missing": Code(
        what="{module} is not here", cause="the studies are in the repository", remedy="run the command in its build",
    ),
    "kind_not_loaded": Code(what="kind {name!r} cannot be loaded"),
    "too_little_memory": Code(
        cause=(
            "a history of {samples:,} samples of {values:,} values needs about {needed} of memory, of which "
            "{free} are free"
        ),
        remedy="take fewer cycles or fewer samples per cycle",
    ),
    # Spring and slider
    "above_stable_time_step": Code(cause="must be above 0 and at most the stable time step {stable_s:.4g} [s]"),
    "calculix_events": Code(what="CalculiX finds other events", cause="{theirs} beside {ours} of the reduced model"),
    "calculix_increments": Code(what="CalculiX left out increments"),
    "expansion_missing": Code(cause="a number [1/K], or a section [expansion], is needed"),
    "fe_branches": Code(cause="'statejump fe' follows 1 to {most} branches"),
    "fe_needs_friction": Code(cause="'statejump fe' needs friction to hold the block"),
    "fe_no_branch": Code(cause="the temperature does not change, 'statejump fe' needs a branch"),
    "fe_one_coefficient": Code(cause="'statejump fe' takes one coefficient of expansion"),
    "fe_rigid_stops": Code(cause="'statejump fe' takes rigid stops only"),
    "fe_zero_only": Code(cause="'statejump fe' takes 0 only"),
    "friction_above_rigidity": Code(
        cause="the friction force {friction_force_N:g} N must be below E A = {rigidity:g} N",
    ),
    "not_below_link_length": Code(cause="must be below link.stress_free_length_m = {stress_free_length_m!r} [m]"),
    "preload_above_rigidity": Code(
        cause="its size and the friction force {friction_force_N:g} N must stay below E A = {rigidity:g} N",
    ),
    "soft_stop_expansion": Code(cause="must be 0 with joint.stop_stiffness_N_per_m: soft stops do not expand"),
    "table_interrupted": Code(what="interrupted; no table was written"),
    # Ribs of an umbrella
    "adaptive_with_memory": Code(
        beside="with joint.friction_law = {law!r}",
        cause="friction with memory is not smooth, use 'rk4'",
    ),
    "angle_outside_friction_cone": Code(
        cause="must be between {least_rad:.9g} and {largest_rad:.9g} [rad], atan of joint.friction_coefficient",
    ),
    "angle_without_friction": Code(
        beside="with start.friction = 'frictionless'",
        cause="must be 0 [rad], where the contact needs no friction",
    ),
    "exceeds_clearance": Code(
        cause=(
            "must be between 0 and joint.radial_clearance_m = {clearance!r} [m], beyond it the joint starts in "
            "deep penetration"
        ),
    ),
    "bias_out_of_range": Code(
        cause=(
            "must be above {least:.9g} and below {most:.9g} [rad], so that the free flare angle lies between 0 "
            "and pi"
        ),
    ),
    "set_by_equilibrium": Code(beside="with start.mode = 'loaded'", cause="equilibrium decides"),
    "friction_without_static_load": Code(cause="must be 0 [rad]: this friction holds no static load"),
    "law_not_with_friction": Code(beside="with joint.friction_law = {law!r}", cause="must be one of {known}"),
    "links_cannot_meet": Code(
        cause=(
            "must be above {least:.9g} and below {most:.9g} [m], or the links cannot meet at a temperature change "
            "of {at_K:g} K"
        ),
    ),
    "not_multiple_of_samples": Code(cause="must be a multiple of output.samples_per_cycle = {samples}"),
    "no_quasi_static_jump": Code(what="there is no quasi-static jump to control"),
    "friction_velocities_unordered": Code(
        cause="must be above joint.friction_v0_m_per_s = {friction_v0_m_per_s!r} [m/s]",
    ),
    "not_above_zero_to_clearance": Code(
        cause="must be above 0 and at most joint.radial_clearance_m = {clearance!r} [m]",
    ),
    "requires_loaded_start": Code(cause="only with start.mode = 'loaded'"),
    "restitution_zero": Code(beside="with joint.dissipation_law = {law!r}", cause="must be above 0 [-]"),
    "spring_without_preload": Code(
        cause="torsion_spring.{spring_key} is 0, and only a biased torsion spring loads the joint",
    ),
    # Rest positions
    "force_components": Code(cause="must be a list of three numbers [N], none beyond {largest_N:g}"),
    "force_out_of_plane": Code(
        cause="joint.type = {type!r} is planar, the third number must be 0; 'cylinder' takes axial forces",
    ),
    "force_rate": Code(cause="must be a list of three numbers [N/K] together with temperature_change_K"),
    "force_temperatures": Code(
        cause="must be a list of numbers between {least_K:g} and {largest_K:g} [K] together with force_rate_N_per_K",
    ),
    "lobe_amplitude": Code(cause="must be at least 0 and below joint.clearance_m = {clearance_m!r} [m]"),
    "mesh_not_read": Code(what="{path} cannot be read"),
    "mesh_without_triangles": Code(what="{path} holds no triangles"),
    "missing_for_joint_type": Code(cause="joint.type = {type!r} needs it"),
    "no_nonzero_force": Code(cause="without a force every position is at rest"),
    "force_section_missing": Code(cause="must be one or more sections [[{name}]] with force_N = [x, y, z]"),
    "only_below_three_dimensions": Code(cause="only for joints in one or two dimensions"),
    "wrong_joint_type": Code(cause="only with joint.type = {types}"),
    "too_many_forces": Code(what="force stands for {forces} forces", cause="must be at most {most}"),
    # Import of decks and meshes
    "bar_without_property": Code(what="{kind} {name!r} has no {property}", remedy="{option} gives all of them one"),
    "bars_table_missing": Code(cause="a table of nodes needs a table of bars", remedy="--bars names it"),
    "deck_suffix": Code(cause="must end with {suffixes}", remedy="--format says what it is"),
    "file_too_large": Code(what="cannot be read", cause="it is larger than {largest}"),
    "include_outside": Code(
        what="line {line}: the included file {included} is outside the deck's folder",
        remedy="copy it beside the deck",
    ),
    "includes_too_deep": Code(what="line {line}: more than {deepest} files include each other"),
    "link_without_temperature": Code(cause="link {link!r} has no temperature"),
    "mesh_suffix": Code(cause="a mesh must end with {suffixes}"),
    "meshio_missing": Code(
        what="meshes are read by meshio, which is not installed",
        remedy="install the Debian package python3-meshio",
    ),
    "no_bars": Code(what="holds no bars"),
    "no_file_name": Code(what="line {line}: {included} is not the name of a file"),
    "included_file_not_found": Code(what="line {line}: there is no included file {included}"),
    "no_section": Code(what="holds no section [[{wanted}]]", remedy="statejump identify --for {wanted} writes one"),
    "undefined_step": Code(cause="the deck has {steps} step{plural}"),
    "undefined_subcase": Code(cause="the subcases of the deck are {subcases}"),
    "not_number": Code(cause="must be a number"),
    "not_meshio": Code(what="not a mesh that meshio reads as {form}"),
    "not_text_file": Code(what="cannot be read", cause="it is not text"),
    "not_vtk": Code(what="not a mesh that VTK reads"),
    "nothing_to_ignore": Code(cause="the deck has no unsupported item of this name"),
    "slider_axis_missing": Code(cause="along which it slides: {directions}, or link"),
    "slider_link_missing": Code(cause="in which the slider is"),
    "deck_ambiguous_set": Code(
        what="set {second} beside set {first}: a case control with {command} = must select one",
    ),
    "deck_bad_geometry": Code(what="{problem}"),
    "deck_bad_number": Code(what="{text} is not {wanted}"),
    "deck_bad_syntax": Code(what="{problem}"),
    "deck_bad_value": Code(what="{problem}"),
    "deck_circular_reference": Code(what="coordinate systems depend on each other in a circle"),
    "deck_duplicate": Code(what="duplicate {what_it_is} {name}"),
    "deck_incomplete": Code(what="incomplete, needs {needed}"),
    "deck_not_supported": Code(what="{card} is not supported", cause="{why}", further=("line", "reason")),
    "deck_several_models": Code(what="superelements and further models are not read"),
    "deck_too_many_items": Code(what="there are more than {most} items"),
    "deck_two_oblique_supports": Code(
        what="node {node} is held in two oblique directions: a case holds axes and one more direction",
    ),
    "deck_undefined": Code(what="there is no {what_it_is} {name}"),
    "mesh_bad_data": Code(what="{problem}"),
    # Trusses
    "driven_truss": Code(
        what="drive {drive!r} rotates a link",
        cause="the quasi-static path has no drives",
        remedy="'statejump reduced --dynamic' runs the case",
    ),
    "free_truss": Code(
        what="truss.free permits rigid motions",
        cause="the quasi-static path and the DEM need supports",
        remedy="'statejump modes' computes its natural frequencies; with supports, remove the key",
    ),
    "beams_not_supported": Code(
        what="{part} rotates its nodes",
        cause="{model} has no rotations of nodes",
        remedy="run its quasi-static path: 'statejump reduced'",
    ),
    "joint_not_in_motion": Code(
        what="{part} has no law of motion",
        cause="it is a joint of quasi-static paths and of modes",
        remedy="run its quasi-static path: 'statejump reduced'",
    ),
    "bounds_of_clearance": Code(
        what="{joint_with_clearance} has clearance",
        cause="not yet: bounds of joints with clearance (class C)",
        remedy="simulate the histories that matter: 'statejump truss answers'",
    ),
    "bounds_of_pad": Code(
        what="{joint_with_clearance}: its friction limit follows its normal force",
        cause="not yet: bounds of pads",
        remedy="give sliders with normal forces, or simulate the histories that matter: 'statejump truss answers'",
    ),
    "bounds_of_open_contact": Code(
        what="{joint_with_clearance} carries no force without friction",
        cause="the direction of its contact is open",
        remedy="preload the joint",
    ),
    "bounds_of_amplified_friction": Code(
        what="friction moments of the joints amplify themselves",
        cause="no bound of the contact forces exists",
        remedy="reduce friction or radii of the journals, or run 'statejump truss answers'",
    ),
    "bounds_of_open_stops": Code(
        what="the positions and forces of stops, plays and cables have no confirmed range",
        cause="the truss is nearly a mechanism without them",
        remedy="stiffen it, or simulate the histories that matter: 'statejump truss answers'",
    ),
    "bounds_of_stop": Code(
        what="{part} may {change} at the reference temperature",
        cause="not yet: bounds across stops, plays and slack cables (class B)",
        remedy="simulate the histories that matter: 'statejump truss answers'",
    ),
    "bounds_of_mechanism": Code(
        what="without friction, nothing holds {mode}",
        cause="friction alone bounds no motion",
        remedy="give this motion a stiffness, for example a spring",
    ),
    "bounds_of_unstable": Code(
        what="the truss is unstable without friction",
        cause="its rest states are not those near one equilibrium",
        remedy="reduce compression, or stiffen the direction in which it gives way",
    ),
    "bounds_without_friction": Code(
        what="no joint has friction", cause="every history returns to the same state", remedy="no bound is needed",
    ),
    "bounds_bad_output": Code(cause="must be node:NAME, node:NAME.x or node:NAME.xy with a free direction, or, of a "
                              "surface, rms, rms:design, rms:rigid, tilt, zernike:K or point:X,Y,Z"),
    "bounds_output_missing": Code(cause="the truss is too large to search for the nodes that may differ most",
                                  remedy="give node:NAME"),
    "bounds_body": Code(
        what="{part} has no bounds",
        cause="its thermal patterns follow different programs, a bound varies one temperature for each item",
    ),
    "bounds_bad_range": Code(cause="must be LOWEST:HIGHEST with LOWEST <= 0 <= HIGHEST [K], for example -80:60"),
    "worst_part": Code(
        what="{part}: the search for worst histories cannot replace its temperatures",
        cause="they are not those of one program",
        remedy="give the part one program and a constant coefficient",
    ),
    "worst_without_members": Code(
        what="no member expands", cause="temperatures do not move the truss",
        remedy="give links or beams thermal_expansion_per_K",
    ),
    "worst_bad_group": Code(cause="no member that expands and is in no earlier group has such a name"),
    "worst_without_path": Code(
        what="no history within the range has a quasi-static path",
        cause="{first}",
        remedy="reduce the range",
    ),
    "no_moving_mass": Code(
        what="nothing that moves has a mass", remedy="give links, beams or nodes a density or a mass",
    ),
    "no_free_dof": Code(
        what="every node is held in all directions",
        cause="nothing moves",
        remedy="free a direction of a node, or run without --dynamic",
    ),
    "rigid_ball_joint_at_rest": Code(
        what="{part} has contact = 'rigid'",
        cause="a quasi-static path does not determine in which direction it begins to slide",
        remedy="'statejump reduced --dynamic' runs the case with motion.start = 'drawn'",
    ),
    "axis_along_beam": Code(cause="it lies along the beam, a direction across it is needed"),
    "axis_along_link": Code(cause="link {link!r} lies along it and has no angle about it"),
    "axis_missing": Code(cause="a list of 3 numbers is needed in a spatial truss"),
    "beam_dimensions": Code(cause="must be {number} numbers above 0 [m] for shape = {shape!r}: {wanted}"),
    "beam_dimensions_missing": Code(cause="shape = {shape!r} needs {wanted}"),
    "beam_dimensions_without_shape": Code(cause="needs a shape other than 'general'"),
    "beam_not_positive": Code(cause="must be numbers above 0"),
    "beam_section_missing": Code(cause="shape = 'general' needs it"),
    "beam_walls": Code(cause="{rule}"),
    "body_axes_parallel": Code(cause="axes x and y of a body must not be parallel"),
    "body_content_not_in_text": Code(beside="in the text of a case file", remedy="save() writes a file beside it"),
    "body_file_missing": Code(cause="a condensed body is read from a file that 'statejump body' makes"),
    "body_node_beside": Code(
        cause="it is {beside_m:.3g} m beside interface node {interface_!r}; allowed is {allowed_m:.2g} m",
        remedy="correct position_m, axis_x and axis_y of the body, or the order of nodes",
    ),
    "body_node_repeated": Code(cause="must be different nodes"),
    "body_nodes": Code(cause="must be one node for each of the {count_} interface nodes of the file: {interface_}"),
    "body_one_each": Code(cause="must have one entry for each of its {count_} patterns"),
    "body_patterns_missing": Code(cause="the file has several thermal patterns, name those that act: {patterns_}"),
    "coincident_ends": Code(cause="its two ends are at one position"),
    "ball_joint_planar": Code(
        cause="a ball joint needs 3: its friction has two directions; in a planar truss a revolute does the same",
    ),
    "ball_joint_rigid": Code(
        cause=(
            'must be "elastic" or "partial_slip" with ball joints that have friction: a contact that sticks '
            'rigidly does not say along which direction of its plane it begins to slide'
        ),
    ),
    "lumped_mass_of_body": Code(
        cause="link {link!r} has {of}, which masses at nodes have not; must be 'consistent'",
    ),
    "centre_not_on_line": Code(cause="in a spatial truss it is on the line of its nodes: [distance, 0]"),
    "column_of_several": Code(cause="its column {column!r} is of {kinds}"),
    "constraint_coefficient": Code(cause="must not be 0, and at least 1e-9 of the largest one"),
    "constraint_length": Code(cause="must be {terms}, one for each node of 'nodes'"),
    "constraint_term_twice": Code(cause="node {node!r} is there twice in direction {direction!r}"),
    "dem_body": Code(text="a link is a body of its own, the DEM has rods"),
    "dem_constraint": Code(text="the DEM has no constraints"),
    "dem_element": Code(text="the DEM does not have an element"),
    "dem_joint": Code(text="the DEM does not have a joint"),
    "dem_joints_too_close": Code(text="more joints are within reach of each other than the DEM can keep apart"),
    "dem_large_rotation": Code(text="a rotation above π/2, which the DEM cannot distinguish from its opposite"),
    "dem_node_without_mass": Code(text="the DEM needs a mass at every node that moves"),
    "dem_path_too_large": Code(text="the path is too large to be kept as a whole"),
    "dem_second_contact": Code(text="a node has a second contact part, in the DEM it has one"),
    "dem_rotation": Code(text="a rotation of a node that the DEM cannot follow"),
    "dem_spring_free_length": Code(text="the DEM needs free lengths of springs above 0"),
    "dem_torsion_out_of_plane": Code(text="the DEM has torsion springs in a plane only"),
    "dem_of_control": Code(
        cause="a truss with what is found goes into a case of its own, which 'statejump compare' checks",
    ),
    "drive_not_planar": Code(cause="drives are of planar trusses"),
    "drive_table_incomplete": Code(cause="a table has both times and angular velocities"),
    "drive_table_length": Code(cause="must be as many numbers as table_time_s has, which are {times}, one or more"),
    "drive_without_speed": Code(cause="a number [rad/s], or a table, is needed"),
    "rejected_by_engine": Code(cause="must be {needed}"),
    "expansion_of_link_missing": Code(cause="a number [1/K], or an expansion, is needed"),
    "fe_link_not_as_drawn": Code(cause="'statejump fe' takes links as long as drawn, {drawn_m:.9g} m"),
    "fe_no_links": Code(cause="'statejump fe' takes trusses with links"),
    "fe_other_joints": Code(cause="beside them there are other joints, or partial slip"),
    "fe_body_deck_keyword": Code(
        cause="'statejump fe' does not renumber *{keyword} in the deck of a body",
        remedy="condense a deck without it",
    ),
    "fe_body_expanding": Code(
        cause="'statejump fe' has no deck of patches that expand",
        remedy="condense the body with mean or rigid patches",
    ),
    "fe_body_factor": Code(
        cause="'statejump fe' computes the mesh of a body with its own stiffness",
        remedy="scale the elastic constants of its deck and condense it again",
    ),
    "fe_body_units": Code(
        cause="'statejump fe' needs decks of bodies in SI units",
        remedy="convert the deck to m and N and condense it again",
    ),
    "fe_cable": Code(cause="'statejump fe' has no cables"),
    "fe_other_parts": Code(
        cause="'statejump fe' takes trusses of links, sliders, Iwan joints and joints with clearance only",
    ),
    "fe_other_parts_with_beams": Code(
        cause="'statejump fe' takes beams and condensed bodies together with links, springs, sliders, hinges and rigid "
        "bodies only",
    ),
    "fe_slider_branches": Code(cause="sliders of 'statejump fe' are followed over at most {most} branches"),
    "fe_slider_shape": Code(cause="sliders of 'statejump fe' follow 'triangle' and 'table'"),
    "fe_soft_sliders": Code(cause="the deck's sliders have rigid stops and no play"),
    "fe_start_friction": Code(cause="the deck's sliders stick where they are drawn"),
    "free_across_axis": Code(
        cause="node {node!r} is free across the axis, {type} on ground needs supports there (fixed or guide_normal)",
    ),
    "held_along_axis": Code(cause="the supports of node {node!r} hold it along the axis"),
    "iwan_spacing": Code(
        cause=(
            "with elements = {elements} the last interval is 1e{power:.0f} times the first one, it must be below "
            "{limit:g} times"
        ),
    ),
    "link_driven_already": Code(cause="drive {drive!r} turns it already"),
    "link_not_at_node": Code(cause="that link ends at {ends}, it must end at {node_key} = {node_wanted!r}"),
    "link_without_length_of_program": Code(
        cause=(
            "the link has no length left at a temperature change of {at_K:g} K, {fraction:g} times that of "
            "program {program!r}"
        ),
    ),
    "equal_links": Code(cause="must be two different links"),
    "links_not_adjacent": Code(cause="the links share no place, neither a node nor a joint between their ends"),
    "mass_missing": Code(cause="what has weight has one of them"),
    "mass_of_body_missing": Code(cause="{of} is of a body of that mass"),
    "mass_of_moving_link_missing": Code(cause="what moves has one of them"),
    "mass_of_condensed_body_missing": Code(
        what="the file of the body has no mass",
        cause="weights and motion need one",
        remedy="condense the body with its density",
    ),
    "mass_of_moving_beam_missing": Code(cause="what moves has one"),
    "mass_of_moving_node_missing": Code(
        cause="the node moves, but no link, spring or constraint gives it a mass or holds it",
        remedy="give it a mass_kg or fix it",
    ),
    "masses_not_lumped": Code(cause="must be 'lumped' {scheme}, as in the DEM"),
    "misspelt_reference": Code(cause="there is no {what_it_is} {name!r}", remedy="did you mean {meant!r}?"),
    "duplicate_name": Code(cause="another {part} has it"),
    "names_of_other_case": Code(what="damaged", cause="/names/{items} has other names than the case"),
    "no_column_of_item": Code(cause="it has no column of {part}"),
    "no_contact": Code(
        what="no joint of the truss is a contact",
        cause="Iwan joints have no cone of Coulomb's, ball joints one in two directions, the problems have one",
    ),
    "no_fit": Code(cause="the truss has no [reflector] whose nodes determine a fit"),
    "no_nodes": Code(cause="must be one or more nodes"),
    "no_radius_left": Code(cause="the {part} has no radius left at a temperature change of {at_K:g} K"),
    "no_ranking": Code(what="no joints are ranked"),
    "undefined_node": Code(cause="the truss has the nodes {known}"),
    "undefined_reference": Code(cause="there is no {what_it_is} {name!r}", remedy="known are {known}"),
    "no_support": Code(what="no node has a support (fixed or guide_normal)", cause="the truss moves as a whole"),
    "node_off_clearance": Code(
        cause=(
            "it is {apart_m:.6g} m from {outer}_node = {other!r}, the clearance is radial_clearance_m = "
            "{clearance_m:g} [m]"
        ),
    ),
    "node_unused": Code(
        what="node {node!r} is not allowed", cause="no link, spring, joint, constraint or support uses it",
    ),
    "equal_nodes": Code(cause="must be two different nodes"),
    "unused_by_scheme": Code(cause="it is not read {scheme}"),
    "nothing_to_scale": Code(cause="it has no value but 0 in this case: there is nothing to scale"),
    "hinge_apart": Code(cause="its nodes are {apart_m:g} m apart", remedy="put them at one position"),
    "hinge_left_table": Code(
        what="hinge {hinge!r} rotates by {rotation_rad:.4g} rad at t = {at_s:.6g} s",
        cause="its moment curve has rotations from {first_rad:.4g} to {last_rad:.4g} rad",
        remedy="extend table_angle_rad and table_moment_N_m",
    ),
    "moment_table_incomplete": Code(cause="table_angle_rad and table_moment_N_m belong together"),
    "moment_table_length": Code(
        cause="must be as many numbers as table_angle_rad has, which are {angles}, two or more"
    ),
    "moment_table_not_increasing": Code(cause="must increase, {after:g} comes after {before:g}"),
    "moment_table_without_zero": Code(cause="must begin at 0 or below and end at 0 or above"),
    "hinge_sticking_missing": Code(cause="reduced.sticking = {sticking!r} needs it, the hinge has no stiffness"),
    "released_twice": Code(cause="both ends release the {released}", remedy="release it at one end"),
    "mean_moment": Code(cause="node {node!r} has a moment, and nothing else carries its part about {direction!r}",
                        remedy="let the reference follow in this direction too"),
    "mean_node_repeated": Code(cause="must be different nodes other than the reference"),
    "mean_undetermined": Code(
        cause="the nodes are on one line or at one position, which does not determine {direction!r} of the reference",
        remedy="name more nodes, or leave out this direction"),
    "mean_weights": Code(cause="must be {nodes_of_mean}, one above 0 for each node of 'nodes'"),
    "rigid_node_fixed": Code(cause="supports hold it and the master, so the force of its arm is not unique",
                             remedy="leave it out"),
    "rigid_node_repeated": Code(cause="must be different nodes other than the master"),
    "rigid_node_twice": Code(cause="another arm carries it", remedy="put the nodes into one [[rigid]]"),
    "rigid_ring": Code(cause="its own arms carry the master", remedy="leave one [[rigid]] of the ring out"),
    "rigid_rotations": Code(cause="must be all rotations, or none"),
    "rigid_without_direction": Code(cause="must name a direction of the truss"),
    "rigid_without_node": Code(cause="must name a node"),
    "offset_with_gravity": Code(
        cause="the weight of a beam acts at its nodes, without the moment of an offset",
        remedy="use a [[rigid]] from the node to a node at the end of the beam",
    ),
    "output_unknown": Code(cause="must be 'node', 'node:NAME', 'rms' or 'tilt'"),
    "partial_slip_rigid": Code(
        cause=(
            'must be "hertz" with reduced.sticking = "partial_slip": a rigid contact has no area of which a part '
            'slips'
        ),
    ),
    "partial_slip_without_cone": Code(
        cause="contacts that slip in part (reduced.sticking = \"partial_slip\") have no cone of Coulomb's",
        remedy='set reduced.sticking to "elastic" or "rigid"',
    ),
    "node_without_rotation": Code(
        cause="no beam, body, hinge or mean rotates the node; a beam end that releases all moments does not"),
    "planar_axis": Code(cause="in a planar truss it is z"),
    "planar_body": Code(
        cause="condensed bodies need 3",
        remedy="give all positions three coordinates and fix the nodes across the plane",
    ),
    "planar_axis_y": Code(cause="in a planar truss y of a section lies in the plane, to the left of its beam"),
    "planar_releases": Code(cause="in a planar truss the ends of a beam release 'Fx' and 'Rz' only"),
    "planar_gradient": Code(cause="in a planar truss the gradient along z of a section must be 0"),
    "planar_rotations": Code(cause="a planar truss rotates about 'z' only"),
    "planar_directions": Code(cause="a planar truss has 'x' and 'y' only"),
    "play_with_partial_slip": Code(
        cause='must be 0 with reduced.sticking = "partial_slip": no contact with both is known',
    ),
    "program_duration_differs": Code(
        cause=(
            "{cycles} cycles of it last {lasts:.10g} s and must last {wanted_s:.10g} s, as thermal.cycles of "
            "thermal.period_s do"
        ),
    ),
    "key_without_number": Code(cause="it is no number and no list of numbers"),
    "program_has_own_cycles": Code(cause="program {program!r} of the case has cycles of its own"),
    "reference_without_section": Code(
        cause="there is no {what_it_is} {name!r}",
        remedy="the file has no section [[{what_it_is}]]",
    ),
    "reflector_axis": Code(cause="must be {dimension} numbers, not zero in every direction"),
    "reflector_missing": Code(what="section [reflector] is missing", remedy="it names the nodes of the surface"),
    "regularised_not_supported": Code(
        cause="{why}, which motion.scheme = 'regularised' has not",
        remedy="leave motion.scheme out",
    ),
    "equal_links_of_joint": Code(cause="must be another link than {outer}"),
    "equal_nodes_of_joint": Code(cause="must be another node than {outer}"),
    "rib_without_neighbour": Code(cause="a single rib has no neighbour"),
    "spatial_axes_needed": Code(what="not drawn", cause="a spatial truss needs axes with projection='3d'"),
    "spectrum_of_unequal_steps": Code(
        cause="a spectrum is of equal steps: leave it out and set motion.steps_per_cycle",
    ),
    "spring_between_supports": Code(cause="neither of these nodes can move"),
    "coincident_spring_nodes": Code(cause="a spring needs two nodes at different places"),
    "spring_without_length": Code(cause="a stiffness of {stiffness:g} N/m gives it at no length that is a number"),
    "start_not_drawn": Code(
        cause="must be 'drawn' with {part}, whose contact is rigid: no path says where it rests",
    ),
    "start_not_stuck": Code(
        beside="with motion.start = 'drawn'",
        cause="must be 'stuck', there is no equilibrium before the motion",
    ),
    "sticking_not_elastic": Code(
        cause="must be 'elastic' or 'partial_slip' {scheme}: its contacts bend, as in the DEM",
    ),
    "stop_missing": Code(cause="needs a stop: give clearance_minus_m or clearance_plus_m"),
    "tables_of_case_file": Code(cause="only where a case file names files"),
    "temperature_from_members_file": Code(cause="thermal.members_file has its temperature"),
    "theta_without_equal_steps": Code(cause="it is of equal steps, which motion.displacement_tolerance_m has not"),
    "drive_times_not_increasing": Code(cause="must increase, {after:g} follows {before:g} [s]"),
    "too_few_steps_of_regularised": Code(
        cause="must be at least {least} with motion.scheme = 'regularised': its steps are explicit",
    ),
    "too_many_joints": Code(
        what="the truss has {count} joints",
        cause="the matrix of a contact problem is dense, so it must be at most {most}",
    ),
    "disconnected_truss": Code(
        what="the truss is in {parts} parts, with the nodes {one_of_each} in one each",
        cause="that of node {loose_node!r} has no support and no link, spring or joint to a part that has one",
    ),
    "truss_without_joints": Code(cause="the truss has no joints, so it has no contact problem"),
    "rotating_part_unsupported": Code(
        cause=(
            "without a link the {part} does not turn, so node {node_wanted!r} must have a support (fixed or "
            "guide_normal)"
        ),
    ),
    "wrong_dimension": Code(cause="must be {dimension} numbers [{unit}], as truss.dimension is {dimension}"),
    "wrong_dimension_of_moment": Code(cause="must be {numbers} [N m], as truss.dimension is {dimension}"),
    "wrong_number_of_links": Code(cause="must be 2 links, or 1 against ground"),
    "wrong_number_of_nodes": Code(cause="must be {wanted}"),
    "coincident_nodes": Code(what="nodes {ends} are at one place, {place_m} m", cause="the {part} has no length"),
    "zero_vector": Code(cause="must not be zero in every direction"),
    # Contact laws
    "tensile_force": Code(cause="must be at least 0 [N]: the bodies do not pull on each other"),
    "column_partner_missing": Code(cause="{partner} goes with it"),
    "compiler_not_run": Code(what="no C++ compiler", cause="$CXX = {compiler!r} cannot be run"),
    "law_argument_out_of_range": Code(text="an argument of the law is out of range", further=("needed",)),
    "first_row_not_zero": Code(cause="must be 0 [N] in the first row, where the contact is made"),
    "history_column_missing": Code(cause="the history needs {needs_}"),
    "history_columns_exclude": Code(beside="beside {other}", cause="the history needs {needs_}, one of them"),
    "law_does_not_compile": Code(what="{header} does not compile"),
    "law_failed": Code(cause="law {law!r}: {why}"),
    "law_needs_penetration": Code(
        beside="with law {law!r}",
        cause="its force depends on the rate of penetration_depth_m, which has to be given",
    ),
    "law_needs_time": Code(cause="law {law!r} depends on velocity"),
    "bad_law": Code(text="a law cannot be used"),
    "no_compiler": Code(
        what="no C++ compiler",
        cause="none of {compilers} is installed",
        remedy="on Debian, apt install g++ libeigen3-dev libboost-dev",
    ),
    "not_positive_integer": Code(cause="must be a whole number from 1"),
    "header_file_missing": Code(what="there is no such file"),
    "other_headers": Code(
        what="these kernel headers are not those that the engine was compiled from",
        remedy="build or install the project again",
    ),
    "history_times_not_increasing": Code(cause="must grow from row to row [s]"),
    "too_many_law_steps": Code(cause="{rows} rows of that many steps are more than {most} in all"),
    # Contact problems
    "fclib_data_missing": Code(what="{data_set} is missing"),
    "fclib_dimension": Code(what="{group}/spacedim = {dimension}", cause="must be 2 or 3"),
    "fclib_group_missing": Code(what="{group} is missing"),
    "fclib_index": Code(what="{group}/{data_set} holds {index}", cause="must be between 0 and {largest}"),
    "fclib_matrix_shape": Code(what="{group} is {rows} x {columns}", cause="must be {wanted_rows} x {wanted_columns}"),
    "fclib_missing": Code(what="/{group} is missing", further=("other",)),
    "fclib_not_data_set": Code(what="{data_set} is not a data set"),
    "fclib_not_group": Code(what="{group} is not a group"),
    "fclib_not_number": Code(what="{group}/{data_set} has {entries} entries", cause="must be one number"),
    "fclib_not_number_list": Code(what="{data_set} is damaged", cause="must be a list of {whole_}numbers"),
    "fclib_not_finite": Code(what="{data_set} is damaged", cause="it has numbers that are not finite"),
    "fclib_pointers": Code(
        what="{group}/p is damaged",
        cause="must be {numbers} numbers that rise from 0 to at most the entries of i and x",
    ),
    "fclib_reactions_length": Code(what="/{group}/r has {entries} entries", cause="q has {needed}"),
    "fclib_singular": Code(what="{group}/R is singular", cause="only equations that can be eliminated are taken"),
    "fclib_storage": Code(what="{group}/nz = {nz}", cause="must be -2, -1 or a number of entries"),
    "fclib_too_few_entries": Code(what="{group} is damaged", cause="p, i and x have less than nz = {nz} entries"),
    "fclib_vector_length": Code(
        what="{group}/q has {entries} entries",
        cause="{contacts} contacts in dimension {dimension} need {needed}",
    ),
    "file_not_found": Code(what="no such file"),
    "not_solved": Code(what="not solved", cause="merit {merit:.3g} after {effort}, tolerance {tolerance:g}"),
    "problem_no_list": Code(what="{name} has shape {shape}", cause="must be a list of numbers"),
    "problem_not_square": Code(what="W has shape {shape}", cause="must be a square array"),
    "problem_shape": Code(what="W has shape {shape}", cause="q has {entries} entries"),
    # Condensed bodies
    "body_arm": Code(
        what="stiffness: rigid motions cause forces, relative error {error:.2g}",
        cause="rotations of node {node!r} are about a point that is {offset_m} m off its position",
        remedy="give the position of that point, or reduce the model to the node itself",
    ),
    "body_axes": Code(
        what="stiffness: rigid motions cause forces, relative error {error:.2g}",
        cause="the axes of the dofs of node {node!r} are rotated against those of node {other!r}",
        remedy="transform the rows by the displacement coordinate system (Nastran's CD), or give the GRID cards",
    ),
    "body_data_missing": Code(what="{data_set} is missing"),
    "body_data_type": Code(what="{data_set} is damaged", cause="must be {wanted}"),
    "body_deck": Code(cause="must have a kind for each node, and temperatures for each pattern and node of the deck"),
    "body_dof_order": Code(
        what="stiffness: rigid motions cause forces, relative error {error:.2g}",
        cause="its rows are in another order: {order}",
        remedy="order the rows node by node: ux uy uz rx ry rz",
    ),
    "body_file_units": Code(what="units = {found!r}", cause="must be 'SI'"),
    "body_format": Code(what="no condensed body", cause="the attribute format is not {wanted!r}"),
    "body_freedoms": Code(cause="must be 3 or 6 for each of {nodes_} nodes"),
    "body_held": Code(
        what="stiffness: rigid motions cause forces, relative error {error:.2g}",
        cause="supports or springs to ground hold the body",
        remedy="reduce the model without supports (SPC, *BOUNDARY) inside the body",
    ),
    "body_indefinite": Code(
        what="stiffness has a negative eigenvalue, {eigenvalue:.2g} of the largest",
        cause="signs of some entries are wrong, or the file has too few digits",
        remedy="write the matrix again with all digits",
    ),
    "body_indefinite_rows": Code(
        what="stiffness: rigid motions cause forces, relative error {error:.2g}, and eigenvalues are negative",
        cause="signs are wrong, or rows and columns are mixed up",
        remedy="compare the order of rows with the list of dofs",
    ),
    "body_load_on_free": Code(
        what="pattern/load: no free shape",
        cause="a load acts on a motion that has no stiffness",
        remedy="give pattern/free_shape",
    ),
    "body_load_resultant": Code(
        what="pattern/load: pattern {pattern!r} has a resultant, relative error {error:.2g}",
        cause="it is no thermal load of a free body, or its rows are in another order than the stiffness",
        remedy="give pattern/free_shape",
    ),
    "body_loads_and_shapes": Code(beside="with pattern/free_shape", cause="one of them determines the other"),
    "body_mass_negative": Code(
        what="mass has a negative eigenvalue, {eigenvalue:.2g} of the largest",
        cause="it is no mass, or its rows are in another order",
        remedy="leave the mass out, or write it again",
    ),
    "body_mass_not_symmetric": Code(
        what="mass is not symmetric, relative error {error:.2g}",
        cause="it has one triangle only, or rows and columns are in different orders",
    ),
    "body_mesh": Code(cause="must be indices of 2, 3 or 4 points of mesh/point_m for each cell"),
    "body_names": Code(cause="must be different texts that are not empty"),
    "body_negative": Code(
        what="stiffness has no positive eigenvalue",
        cause="its sign is reversed",
        remedy="multiply it by -1",
    ),
    "body_not_finite": Code(cause="must hold finite numbers"),
    "body_not_free": Code(
        what="stiffness: rigid motions cause forces, relative error {error:.2g}",
        cause=(
            "rows are in another order, displacement coordinate systems are ignored, units differ, or supports hold "
            "the body"
        ),
        remedy="check rows, GRID cards and units",
    ),
    "body_not_numbers": Code(cause="must be an array of numbers"),
    "body_not_symmetric": Code(
        what="stiffness is not symmetric, relative error {error:.2g}",
        cause="rows and columns are in different orders, or the file is damaged",
    ),
    "body_pair": Code(cause="must be NODE=SYSTEM with two whole numbers"),
    "body_place": Code(cause="must be NSET=X,Y,Z"),
    "body_patch": Code(cause="must be empty or one of {patches}"),
    "body_row_order": Code(
        what="stiffness: rigid motions cause forces, relative error {error:.2g}",
        cause="the rows belong to the nodes in another order",
        remedy="order the nodes as the rows",
    ),
    "body_row_order_named": Code(
        what="stiffness: rigid motions cause forces, relative error {error:.2g}",
        cause="the rows of node {node!r} are those of a node at the position of {other!r}",
        remedy="order the nodes as the rows",
    ),
    "body_shape": Code(cause="has the shape {shape}, must have {wanted}"),
    "body_shapes_missing": Code(cause="{patterns} patterns need free shapes or loads"),
    "body_sign": Code(
        what="stiffness: rigid motions cause forces, relative error {error:.2g}",
        cause="an axis of node {node!r} has the opposite sign to that of node {other!r}",
        remedy="use right-handed axes at every node",
    ),
    "body_stiffness_shape": Code(cause="has the shape {shape}, must be square with at least {dofs} rows"),
    "body_triangle": Code(
        what="stiffness is not symmetric, relative error {error:.2g}",
        cause="it has one triangle only",
        remedy="write the whole matrix",
    ),
    "body_units": Code(
        what="stiffness: rigid motions cause forces, relative error {error:.2g}",
        cause="stiffness and positions have different units ({unit}): positions must be multiplied by {factor:.6g}",
        remedy="convert both to SI units",
    ),
    "body_version": Code(what="version = {found}", cause="this statejump reads version {newest}"),
    "matrix_entry_twice": Code(what="matrix {matrix}: two different entries at row {row}, column {column}"),
    "matrix_file_damaged": Code(what="cannot be read", cause="{form} is damaged, or the file is of another kind"),
    "matrix_held": Code(
        what="a support holds node {node}",
        cause="the diagonal of a held dof is 1e36",
        remedy="write the matrix of the model without *BOUNDARY",
    ),
    "matrix_inner_nodes": Code(
        what="node {node} is an internal node of Abaqus",
        cause="the matrix is that of the whole model, with Lagrange multipliers",
        remedy="write a substructure (*SUBSTRUCTURE MATRIX OUTPUT)",
    ),
    "matrix_labels_count": Code(
        what="the stiffness has {rows} rows, the files list {labels} dofs",
        remedy="give the .asm or .pch file of the same run",
    ),
    "matrix_load_columns": Code(cause="it has {columns} columns for {names} pattern names"),
    "matrix_op2_words": Code(
        what="no OUTPUT2 file with words of four bytes",
        remedy="write the matrices with EXTSEOUT(DMIGPCH) or OUTPUT4",
    ),
    "matrix_missing": Code(
        what="no stiffness",
        cause="the files have the matrices {known}",
        remedy="name the stiffness, or write it in Nastran with EXTSEOUT(DMIGPCH) or EXTSEOUT(DMIGOP2)",
    ),
    "matrix_node_missing": Code(
        what="node {node} has no position",
        remedy="give a file with GRID cards, *NODE, or a table name,x_m,y_m,z_m",
    ),
    "matrix_of_calculix": Code(
        what="a matrix of CalculiX's *SUBSTRUCTURE GENERATE",
        cause="CalculiX writes the stiffness of the held interior there, not the reduced one",
        remedy="condense the deck with 'statejump body condense'",
    ),
    "matrix_other_kind": Code(what="a matrix of kind {kind}", cause="must be a stiffness or a mass"),
    "matrix_other_rows": Code(what="matrix {matrix}: its {rows} rows are not those of the stiffness"),
    "matrix_unknown": Code(cause="must be one of {known}"),
    "matrix_without_labels": Code(
        what="the {rows} rows of the stiffness have no node numbers",
        remedy="give a file with EXTRN or ASET cards, or nodes with equally many dofs",
    ),
    "matrix_without_nodes": Code(what="the stiffness has no dofs of nodes"),
    "condense_beam_node": Code(
        what="node {node} belongs to a beam",
        cause="the section of a beam has several nodes in CalculiX",
        remedy="name nodes of solids or shells only",
    ),
    "condense_dependent": Code(
        what="node {node} has no dofs of its own",
        cause="an equation, a tie or a joint of shells makes it depend on other nodes",
        remedy="name other nodes",
    ),
    "condense_element": Code(
        what="line {line}: elements of type {kind}",
        cause="bodies are condensed of {known}",
        remedy="keep other elements outside of the body",
    ),
    "condense_initial": Code(
        what="*INITIAL CONDITIONS has several temperatures",
        cause="a body has one reference temperature",
    ),
    "condense_keyword": Code(what="line {line}: *{keyword} is not supported", cause="{why}"),
    "condense_kind": Code(cause="the kind of a patch must be one of {kinds}"),
    "condense_loose": Code(
        what="a mode has no stiffness",
        cause="a part is loose, or a single row of elements with reduced integration moves without strain",
        remedy="use two elements through the thickness",
    ),
    "condense_modes": Code(what="{count} modes are too many", cause="the mesh has at most {most}"),
    "condense_no_density": Code(cause="the deck has no *DENSITY"),
    "condense_no_displacements": Code(what="CalculiX printed no displacements"),
    "condense_no_interface": Code(cause="a body needs at least one set of nodes"),
    "condense_no_set": Code(what="there is no set of nodes {name!r}", cause="known are {known}"),
    "condense_no_shells": Code(cause="the deck has no shells"),
    "condense_no_step": Code(cause="the deck has {steps} steps, that step prescribes no temperatures"),
    "condense_node_cold": Code(cause="node {node} has no temperature, {count} nodes in all"),
    "condense_not_constant": Code(
        what="line {line}: *{keyword} depends on temperature",
        cause="a condensed body is linear",
        remedy="give the value at the mean temperature",
    ),
    "condense_one_node": Code(cause="the set must have one node, has {count}"),
    "condense_patch_line": Code(cause="its nodes lie on one line, or are less than 3: their rotation is undetermined"),
    "condense_patches_overlap": Code(what="two rigid patches share a node"),
    "condense_pattern": Code(
        cause="must be NAME=WHAT with uniform, x, y, z, thickness, set:NSET, step:N or a CSV table",
    ),
    "condense_pattern_twice": Code(cause="two patterns have this name"),
    "condense_rigid_shell": Code(
        what="rigid patches need solid elements",
        cause="CalculiX expands shells, whose nodes have several layers",
        remedy="name mean patches",
    ),
    "condense_singular": Code(
        what="the equations of the condensation are singular",
        cause="the patches do not hold the body, or a part of it is loose",
        remedy="name more patches, or connect the mesh",
    ),
    # Identification
    "loop_columns_missing": Code(cause="a loop has displacement_m and force_N, or rotation_rad and moment_N_m"),
    "loop_constant": Code(cause="is the same in every row: that is no loop"),
    "loop_falls": Code(what="the {force} falls as the {displacement} rises", cause="its sign is reversed"),
    "loop_gives_energy": Code(
        what="the loop gives out energy",
        cause="{energy_J:.4g} J: the sign of the {force} is reversed",
    ),
    "loop_of_two_kinds": Code(
        beside="beside {other}",
        cause="a loop is force over displacement or moment over rotation",
    ),
    "model_unknown": Code(cause="must be {auto} or of {models}"),
    "no_joint_model": Code(cause="names no joint"),
    "no_table_of_fit": Code(cause="must be 'parameters', 'models' or 'rows'"),
    "not_one_of": Code(cause="must be one of {known}"),
    "partner_missing": Code(cause="it goes with {partner}"),
    "target_of_displacement": Code(cause="it takes a loop of force over displacement"),
    "target_of_rotation": Code(cause="it takes a loop of moment over rotation"),
    "too_few_rows": Code(what="{rows} rows are too few", cause="a loop needs {fewest}"),
    # Bores
    "bore_bad_faces": Code(text="the mesh of a bore has faces that are missing or degenerate"),
    "bore_in_millimetres": Code(
        what=(
            "the bore's mean radius {mean_radius_m:.6g} m is {ratio:.3g} times the journal's "
            "{journal_radius_m:.6g} m: are the coordinates in millimetres?"
        ),
    ),
    "bore_inside_out": Code(text="the faces of the mesh point away from the bore"),
    "bore_no_bore": Code(text="the mesh surrounds no axis"),
    "bore_no_ring": Code(
        what=(
            "the bore's section at {z_m:.6g} m from its middle is no ring about the centre of its circle of least "
            "squares"
        ),
    ),
    "bore_open": Code(text="the mesh of a bore lacks an end or has holes"),
    "bore_out_of_range": Code(text="an argument for the mesh is out of range"),
    "bore_self_intersects": Code(text="faces of the mesh pass through each other"),
    "bore_too_coarse": Code(text="the mesh has too few facets"),
    "bore_too_large": Code(text="the mean radius is too large"),
    "bore_too_small": Code(text="the mean radius is too small"),
    "bore_unreadable": Code(text="the mesh of a bore cannot be read"),
    "bore_without_wall": Code(
        what="the bore's section at {z_m:.6g} m from its middle has no wall at {angle_deg:.1f} degrees",
    ),
    "journal_too_large": Code(cause="the journal does not go into the bore of mean radius {mean_radius_m:.6g} m"),
    # Surfaces
    "array_not_finite": Code(beside="as an array", cause="must hold finite numbers"),
    "array_of_other_shape": Code(beside="as an array", cause="must have a row of x, y, z for each of {count} nodes"),
    "displacement_of_other_shape": Code(
        beside="as an array",
        cause="must, as position_m, have a row of x, y, z for each node",
    ),
    "fit_undetermined": Code(what="{count} nodes do not determine a best fit", remedy="more of them"),
    "no_direction": Code(cause="must be three numbers that are not all 0"),
    "samples_without_value": Code(what="no sample has a value"),
    "node_column_missing": Code(cause="a node needs its place and its displacement"),
    "nodes_along_axis": Code(what="the nodes lie on a line along the axis"),
    "nodes_on_one_line": Code(what="the nodes lie on one line: how they turn about it is not determined"),
    "not_a_fraction": Code(cause="must be above 0 and below 1"),
    "profile_without_zernike": Code(what="the nodes lie in one plane with the axis: a profile has no Zernike terms"),
    "surface_undetermined": Code(what="{count} nodes do not determine a surface", remedy="more of them"),
    "terms_out_of_range": Code(cause="must be a whole number, between 1 and {most}"),
    "zernike_undetermined": Code(what="{count} nodes do not determine {terms} Zernike terms", remedy="ask for fewer"),
    # CalculiX and orbits
    "calculix_failed": Code(what="CalculiX did not come to the end"),
    "calculix_timeout": Code(what="CalculiX was not done after {limit_s:g} s"),
    "missing_column": Code(what="column {column} is missing, needed are {needed}"),
    "member_name": Code(what="line {line}: name", cause="must be a text that is not empty"),
    "calculix_missing": Code(
        what="CalculiX is not installed",
        cause="there is no {program} on the PATH",
        remedy="install Debian's calculix-ccx",
    ),
    "members_file_not_found": Code(what="no such file of members"),
    "orbit_not_periodic": Code(
        what="no orbit repeats itself within {orbits}",
        cause="members are heavy against the length of the orbit",
    ),
    "shadow_times": Code(cause="must be pairs of times that rise, from 0 to {period_s:g} [s]"),
    "too_many_members": Code(what="has more than {most} members"),
    "wrong_number_of_members": Code(cause="must be 1 to {most} members, each with a name of its own"),
    # Studies
    "cannot_vary": Code(what="cannot vary {varied}"),
    "contact_force_vanishes": Code(
        what="the quasi-static path ends at a temperature change of {where_K:.6g} K, where the contact force vanishes",
        remedy="load the joint with a larger torsion_spring.bias_rad",
    ),
    # Failures of the engine, which gives the sentence
    "mechanism": Code(text="the truss has free modes though no joint slips", further=("modes",)),
    "held_mechanism": Code(text="the truss has free modes as drawn, with every joint held", further=("modes",)),
    "friction_exhausted": Code(
        text="the truss has free modes once the friction of joints is at its bound",
        further=("modes",)),
    "overloaded": Code(text="the loads need more friction at the start than a joint has", further=("load_fraction",)),
    "buckled": Code(text="the truss is unstable whatever the joints do", further=("modes",)),
    "unloaded_joint": Code(text="a joint carries no force at the start, its position in the play is undetermined"),
    "jump_across_play": Code(text="the contact force of a revolute vanishes on the way"),
    "singular": Code(text="no equilibrium found: the equations are singular to rounding"),
    "not_converged": Code(
        text="no equilibrium found: the iteration does not end",
        further=("force_residual", "closure_residual_m")),
    "no_continuation": Code(text="the truss has no slow continuation: slip runs away or the truss snaps through"),
    "several_continuations": Code(text="statics does not choose between several continuations"),
    "too_many_steps": Code(text="the path is found only in too many steps", further=("steps", "last_step_s")),
    "law_left_range": Code(
        text="a contact law is evaluated outside of its range",
        further=("penetration_depth_m", "limit_m")),
}
