// SPDX-License-Identifier: GPL-3.0-or-later
import "./page.css";
import { setUpCharts } from "./charts";
import { setUpCampaigns } from "./campaign";
import { loadPage } from "./payload";
import { Playhead } from "./playhead";
import { setUpPlayers } from "./player";
import { setUpStrips } from "./strips";
import { setUpTheme } from "./theme";
import { setUpTruss } from "./truss";

setUpTheme();
const { runs, campaigns } = loadPage();
setUpCampaigns(campaigns);
const heads = runs.map((run) => new Playhead(run));
setUpPlayers(runs, heads);
runs.forEach((run, i) => {
  const head = heads[i]!;
  setUpTruss(run);
  setUpStrips(run, head);
  setUpCharts(run, head);
  // Rows of the table of events bring the replay there.
  for (const row of document.querySelectorAll<HTMLElement>(`#${run.data.id} .events [data-time]`)) {
    row.addEventListener("click", () => head.change({ time: Number(row.dataset["time"]) }));
  }
});
