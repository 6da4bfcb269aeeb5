// SPDX-License-Identifier: GPL-3.0-or-later
import * as Plot from "@observablehq/plot";
import { element } from "./elements";
import { Model, Run } from "./payload";
import { Playhead } from "./playhead";

interface Band {
  from: number;
  to: number;
  row: string;
  state: number;
}

// Rows that a strip may have before its names could not be read.
const MOST_ROWS = 24;

function bandsOf(model: Model, contact: { state: string; label: string }, row: string): Band[] {
  const states = model.column(contact.state),
    bands: Band[] = [];
  if (!states) return bands;
  for (let i = 0; i < states.length; i++) {
    const open = bands[bands.length - 1],
      state = states[i] ?? 0,
      time = model.time[i] ?? 0;
    if (open) open.to = time;
    if (!open || open.state !== state) bands.push({ from: time, to: time, row, state });
  }
  return bands;
}

/** What every contact does over time, in both models: a strip each, in the colours of the replay. */
export function setUpStrips(run: Run, head: Playhead): void {
  const place = document.querySelector<HTMLElement>(`.strips[data-run="${run.data.id}"]`);
  const { contacts, states } = run.data.scene;
  if (!place || contacts.length * run.models.length > MOST_ROWS || contacts.length === 0) return;
  const rows = contacts.flatMap((contact) =>
    run.models.map((model) => ({
      contact,
      model,
      row: run.models.length > 1 ? `${contact.label}, ${model.key === "dem" ? "DEM" : model.key}` : contact.label,
    })),
  );
  const bands = rows.flatMap(({ contact, model, row }) => bandsOf(model, contact, row));
  const holder = element("div", { class: "plot" });
  let line: SVGLineElement | null = null,
    svg: (Plot.Plot & (SVGSVGElement | HTMLElement)) | null = null,
    drawn = 0;

  const follow = () => {
    const x = svg?.scale("x");
    if (!line || !x) return;
    line.setAttribute("x1", String(x.apply(head.time)));
    line.setAttribute("x2", String(x.apply(head.time)));
  };
  const draw = () => {
    const width = Math.floor(holder.clientWidth);
    if (width < 40 || width === drawn) return;
    drawn = width;
    const height = 24 * rows.length + 44;
    svg?.remove();
    svg = Plot.plot({
      width,
      height,
      marginLeft: 116,
      marginBottom: 36,
      marginTop: 6,
      marginRight: 14,
      style: {
        background: "transparent",
        color: "var(--ink)",
        fontFamily: "inherit",
        fontSize: "12px",
        overflow: "visible",
      },
      x: { label: "Time [s]", labelAnchor: "center", labelArrow: "none" },
      y: { label: null, domain: rows.map(({ row }) => row), padding: 0.25, tickSize: 0 },
      ariaLabel: "State of every contact over time",
      marks: [
        Plot.barX(bands, {
          x1: "from",
          x2: "to",
          y: "row",
          fill: (band: Band) => states[band.state]?.colour,
          // Gaps are an outline, so that they are told from contact without colour.
          fillOpacity: (band: Band) => (band.state === 0 ? 0.18 : 1),
          title: (band: Band) =>
            `${states[band.state]?.label}: ${band.from.toPrecision(4)} to ${band.to.toPrecision(4)} s`,
        }),
      ],
    }) as Plot.Plot & (SVGSVGElement | HTMLElement);
    svg.setAttribute("role", "img");
    svg.addEventListener("click", (event) => {
      const x = svg?.scale("x");
      if (x?.invert) head.change({ time: x.invert((event as MouseEvent).clientX - svg!.getBoundingClientRect().left) });
    });
    line = document.createElementNS("http://www.w3.org/2000/svg", "line");
    line.setAttribute("y1", "2");
    line.setAttribute("y2", String(height - 36));
    line.setAttribute("class", "now");
    svg.append(line);
    holder.append(svg);
    follow();
  };
  place.append(
    element(
      "p",
      { class: "legend" },
      ...states.map((state, i) => element("span", { class: "key" }, swatchOf(state.colour, i === 0), state.label)),
    ),
    holder,
  );
  new ResizeObserver(draw).observe(holder);
  head.listen(follow);
}

/** A small square in the colour of a state; that of a gap is an outline. */
export function swatchOf(colour: string, open: boolean): HTMLElement {
  return element("i", {
    class: "swatch",
    "aria-hidden": "true",
    style: open ? `border-color:${colour}` : `background:${colour};border-color:${colour}`,
  });
}
