// SPDX-License-Identifier: GPL-3.0-or-later
// Charts of a campaign: distributions or curves of its outcomes, and what they follow.
import * as Plot from "@observablehq/plot";
import { element, short } from "./elements";

interface Histogram {
  title: string;
  label: string;
  counts: number[];
  edges: number[];
  note: string;
  quantiles: number[];
}
interface Curve {
  title: string;
  x: string;
  y: string;
  z: string;
  points: { x: number; y: number; z: string }[];
}
interface Ranks {
  title: string;
  bars: { parameter: string; value: number }[];
}
export interface CampaignData {
  id: string;
  histograms: Histogram[];
  curves: Curve[];
  ranks: Ranks[];
}

const STYLE = {
  background: "transparent",
  color: "var(--ink)",
  fontFamily: "inherit",
  fontSize: "12px",
  overflow: "visible",
};
// Light to dark through blue: apart in grey as well.
const SHADES = ["var(--reduced)", "var(--stored)", "var(--ink)", "var(--friction)", "var(--damping)", "var(--pass)"];

type Draw = (width: number) => SVGSVGElement | HTMLElement;

/** A figure that is drawn again when its width changes. */
function figure(title: string, note: string, draw: Draw): HTMLElement {
  const holder = element("div", { class: "plot still" });
  let drawn = 0;
  new ResizeObserver(() => {
    const width = Math.floor(holder.clientWidth);
    if (width < 40 || width === drawn) return;
    drawn = width;
    const picture = draw(width);
    picture.setAttribute("role", "img");
    holder.replaceChildren(picture);
  }).observe(holder);
  const caption = element(
    "figcaption",
    {},
    element("strong", {}, title),
    ...(note ? [element("span", { class: "mark" }, note)] : []),
  );
  return element("figure", { class: "chart" }, caption, holder);
}

function histogram(data: Histogram): HTMLElement {
  const bars = data.counts.map((count, i) => ({ count, from: data.edges[i] ?? 0, to: data.edges[i + 1] ?? 0 }));
  return figure(data.title, data.note, (width) =>
    Plot.plot({
      width,
      height: Math.round(Math.min(260, Math.max(190, width * 0.55))),
      marginLeft: 52,
      marginBottom: 42,
      style: STYLE,
      x: { label: data.label, labelAnchor: "center", labelArrow: "none" },
      y: { label: "Samples in the bar", labelAnchor: "center", labelArrow: "none" },
      ariaLabel: `Distribution of ${data.title}: 5, 50 and 95 % at ${data.quantiles.map((value) => short(value, 4)).join(", ")}`,
      marks: [
        Plot.gridY({ stroke: "var(--grid)", strokeOpacity: 1 }),
        Plot.rectY(bars, {
          x1: "from",
          x2: "to",
          y: "count",
          fill: "var(--stored)",
          insetLeft: 0.3,
          insetRight: 0.3,
          title: (bar) => `${bar.count} samples from ${short(bar.from, 4)} to ${short(bar.to, 4)}`,
        }),
        Plot.ruleX(data.quantiles, { stroke: "var(--ink)", strokeDasharray: "4 3" }),
        Plot.ruleY([0], { stroke: "var(--line)" }),
      ],
    }),
  );
}

function curve(data: Curve): HTMLElement {
  const groups = [...new Set(data.points.map((point) => point.z))];
  const legend = data.z && groups.length <= SHADES.length ? `${data.z}` : "";
  const shade = (z: string) => SHADES[groups.indexOf(z) % SHADES.length] ?? "var(--ink)";
  const made = figure(data.title, legend, (width) =>
    Plot.plot({
      width,
      height: Math.round(Math.min(300, Math.max(210, width * 0.6))),
      marginLeft: 58,
      marginBottom: 42,
      style: STYLE,
      x: { label: data.x, labelAnchor: "center", labelArrow: "none" },
      y: { label: data.y, labelAnchor: "center", labelArrow: "none" },
      ariaLabel: data.title,
      marks: [
        Plot.gridX({ stroke: "var(--grid)", strokeOpacity: 1 }),
        Plot.gridY({ stroke: "var(--grid)", strokeOpacity: 1 }),
        ...groups.flatMap((z, i) => {
          const points = data.points.filter((point) => point.z === z);
          // Lines may lie on each other: the first ones are wider.
          const wide = 1.4 + 2.4 * Math.max(0, Math.min(groups.length, SHADES.length) - 1 - i);
          return [Plot.line(points, { x: "x", y: "y", stroke: shade(z), strokeWidth: wide })];
        }),
        Plot.tip(
          data.points,
          Plot.pointer({
            x: "x",
            y: "y",
            maxRadius: 30,
            fill: "var(--paper)",
            stroke: "var(--line)",
            title: (point) =>
              `${data.x}: ${short(point.x, 4)}\n${data.y}: ${short(point.y, 4)}${data.z ? `\n${data.z}: ${point.z}` : ""}`,
          }),
        ),
      ],
    }),
  );
  if (legend) {
    made.querySelector("figcaption")?.append(
      ...groups.map((z) =>
        element(
          "span",
          { class: "key mark" },
          element("i", {
            class: "swatch",
            "aria-hidden": "true",
            style: `background:${shade(z)};border-color:${shade(z)}`,
          }),
          z,
        ),
      ),
    );
  }
  return made;
}

function ranks(data: Ranks): HTMLElement {
  return figure(data.title, "", (width) =>
    Plot.plot({
      width,
      height: 26 * data.bars.length + 44,
      marginLeft: Math.min(230, width * 0.5),
      marginRight: 40,
      marginBottom: 36,
      marginTop: 4,
      style: STYLE,
      x: { label: "Rank correlation", labelAnchor: "center", labelArrow: "none", domain: [-1, 1] },
      y: { label: null, domain: data.bars.map((bar) => bar.parameter), padding: 0.3, tickSize: 0 },
      ariaLabel: `${data.title} follows ${data.bars.map((bar) => `${bar.parameter} by ${bar.value.toFixed(2)}`).join(", ")}`,
      marks: [
        Plot.gridX({ stroke: "var(--grid)", strokeOpacity: 1 }),
        Plot.barX(data.bars, {
          x: "value",
          y: "parameter",
          fill: (bar) => (bar.value < 0 ? "var(--reduced)" : "var(--stored)"),
        }),
        // Right of the bar, or of zero: left of it are the names.
        Plot.text(data.bars, {
          x: (bar) => Math.max(0, bar.value),
          y: "parameter",
          text: (bar) =>
            bar.value
              .toFixed(2)
              .replace(/^-(?!0\.00$)/, "−")
              .replace("-0.00", "0.00"),
          dx: 6,
          textAnchor: "start",
        }),
        Plot.ruleX([0], { stroke: "var(--quiet)" }),
      ],
    }),
  );
}

/** Fills the places for the charts of campaigns. */
export function setUpCampaigns(campaigns: CampaignData[]): void {
  for (const data of campaigns) {
    for (const place of document.querySelectorAll<HTMLElement>(`.campaign[data-campaign="${data.id}"]`)) {
      if (place.dataset["what"] === "histograms") place.append(...data.histograms.map(histogram));
      if (place.dataset["what"] === "curves") place.append(...data.curves.map(curve));
      if (place.dataset["what"] === "ranks") place.append(...data.ranks.map(ranks));
    }
  }
}
