# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs one sample of a campaign in YADE; started by ``yade-batch``, once per line of its table.

    statejump montecarlo CAMPAIGN.toml --yade-batch samples.table
    export PYTHONPATH=build/python
    yade-batch --job-threads=1 --log=@.log samples.table yade_scripts/runner/batch_case.py

Each line writes the history ``samples.table.sample_<number>.csv`` and ``….outcomes.json``, the numbers that ``statejump
montecarlo`` writes into a row of its table. An interrupted batch cannot be resumed; use ``statejump montecarlo`` for
this.
"""
import json
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parent))
from statejump.campaign.yade_batch import BatchSample
from statejump.core.errors import StatejumpError
from statejump.core.samples import read_samples
from statejump.core.tables import write_columns
from yade import utils

utils.readParamsFromTable(unknownOk=True, noTableOk=False)
from yade.params import table

table_file = Path(os.environ["YADE_BATCH"].rpartition(":")[0]).resolve()
try:
    sample = BatchSample(vars(table))
except StatejumpError as problem:
    print(f"ERROR {problem}", flush=True)
    os._exit(2)
history = table_file.with_name(f"{table_file.name}.sample_{sample.index}.csv")
values, samples = history.with_suffix(".case.json"), history.with_suffix(".samples")
values.write_text(json.dumps(sample.dem_values()))
os.environ["STATEJUMP_CASE_JSON"], os.environ["STATEJUMP_OUTPUT"] = str(values), str(samples)
# The script that statejump starts; it uses the namespace of the main script.
runner = Path(sys.argv[0]).resolve().with_name("run_case.py")
exec(compile(runner.read_text(), str(runner), "exec"), globals())
values.unlink()
write_columns(read_samples(samples), history)
history.with_suffix(".outcomes.json").write_text(
    json.dumps({"sample": sample.index, **sample.outcomes(samples)}, indent=2) + "\n"
)
