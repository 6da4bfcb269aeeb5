// SPDX-License-Identifier: GPL-3.0-or-later
import * as Plot from "@observablehq/plot";
import { element, number } from "./elements";
import { AxisData, ChartData, MarkData, Run, SeriesData, StageData } from "./payload";
import { Playhead } from "./playhead";

// As the figures of the commands: a thick light line under a thin dark dashed one.
const STYLES: Record<string, { stroke: string; width: number; dash?: string; label: string }> = {
  reduced: { stroke: "var(--reduced)", width: 4.5, label: "Reduced model" },
  dem: { stroke: "var(--dem)", width: 1.4, dash: "6 3", label: "DEM (YADE)" },
  supplied: { stroke: "var(--ink)", width: 1.4, label: "supplied" },
  stored: { stroke: "var(--stored)", width: 1.4, label: "stored" },
  friction: { stroke: "var(--friction)", width: 1.4, label: "dissipated by friction" },
  damping: { stroke: "var(--damping)", width: 1.4, label: "dissipated by damping" },
};
const SHADES = ["var(--band)", "transparent"];
const RING_SIDES = 180;
const SIGN = 16; // pixels across

const signOf = (mark: MarkData, place: number) => (mark.role === "jump" ? "J" : String(place + 1));

interface Dot {
  x: number;
  y: number;
  time: number;
}
interface Line {
  data: SeriesData;
  dots: Dot[];
}
type Svg = (SVGSVGElement | HTMLElement) & Plot.Plot;

const shown = (axis: AxisData, value: number) => (value - axis.start) * axis.scale;

function lines(chart: ChartData, run: Run): Line[] {
  return chart.series.map((data) => {
    const model = run.models.find((candidate) => candidate.key === data.model);
    const x = model?.column(data.x),
      y = model?.column(data.y);
    const dots =
      !model || !x || !y
        ? []
        : Array.from(model.time, (time, i) => ({
            x: shown(chart.x, x[i] ?? 0),
            y: shown(chart.y, y[i] ?? 0),
            time,
          }));
    return { data, dots };
  });
}

function bands(stages: StageData[], axis: AxisData): Plot.Markish[] {
  const from = (stage: StageData) => stage.start_s * axis.scale,
    to = (stage: StageData) => stage.end_s * axis.scale;
  const whole = to(stages[stages.length - 1]!) - from(stages[0]!);
  return [
    Plot.rectX(stages, { x1: from, x2: to, fill: (_: StageData, i: number) => SHADES[i % 2] }),
    Plot.text(
      stages.filter((stage) => to(stage) - from(stage) > 0.05 * whole),
      {
        x: (stage: StageData) => (from(stage) + to(stage)) / 2,
        text: "name",
        frameAnchor: "top",
        dy: -14,
        fontSize: 11,
        fill: "var(--quiet)",
      },
    ),
  ];
}

/** A chart that follows the replay and lets it be moved. */
class Chart {
  readonly root: HTMLElement;
  private readonly holder = element("div", { class: "plot" });
  private readonly lines: Line[];
  private svg: Svg | null = null;
  private ring: SVGCircleElement | null = null;
  private width = 0;

  constructor(
    private readonly chart: ChartData,
    private readonly run: Run,
    private readonly head: Playhead,
    energy: boolean,
  ) {
    this.lines = lines(chart, run);
    const caption = element("figcaption", {}, element("strong", {}, chart.title));
    chart.marks.forEach((mark, i) =>
      caption.append(
        element(
          "span",
          { class: `mark ${mark.role}` },
          element("b", {}, signOf(mark, i)),
          ` ${mark.label} ${mark.value}`,
        ),
      ),
    );
    this.root = element("figure", { class: energy ? "chart energy-chart" : "chart" }, caption, this.holder);
    if (energy) caption.append(energyLegend(chart, run));
    new ResizeObserver(() => this.draw()).observe(this.holder);
    head.listen(() => this.follow());
  }

  private draw(): void {
    const width = Math.floor(this.holder.clientWidth);
    if (width < 40 || width === this.width) return;
    this.width = width;
    const { chart } = this;
    const energy = chart.series.some((series) => series.style === "supplied");
    const marks: Plot.Markish[] = [
      ...(chart.stages && this.run.data.stages.length ? bands(this.run.data.stages, chart.x) : []),
      Plot.gridX({ stroke: "var(--grid)", strokeOpacity: 1 }),
      Plot.gridY({ stroke: "var(--grid)", strokeOpacity: 1 }),
      ...chart.rings.map((radius) =>
        Plot.line(
          Array.from({ length: RING_SIDES + 1 }, (_, i) => (2 * Math.PI * i) / RING_SIDES),
          { x: (a: number) => radius * Math.cos(a), y: (a: number) => radius * Math.sin(a), stroke: "var(--quiet)" },
        ),
      ),
      ...this.lines.map(({ data, dots }) => {
        const style = STYLES[data.style];
        const thick = energy && data.model === "reduced";
        return Plot.line(dots, {
          x: "x",
          y: "y",
          stroke: style?.stroke,
          strokeWidth: thick ? 5 : style?.width,
          strokeOpacity: thick ? 0.35 : 1,
          strokeLinecap: "round",
          strokeDasharray: energy ? (data.model === "dem" ? "6 3" : undefined) : style?.dash,
        });
      }),
      ...this.markSigns(width),
      Plot.tip(
        this.lines.flatMap(({ data, dots }) => dots.map((dot) => ({ ...dot, style: data.style }))),
        Plot.pointer({
          x: "x",
          y: "y",
          maxRadius: 30,
          fill: "var(--paper)",
          stroke: "var(--line)",
          title: (dot: Dot & { style: string }) =>
            `${STYLES[dot.style]?.label ?? ""}\n${axisValue(chart.x, dot.x)}\n${axisValue(chart.y, dot.y)}\nt = ${number(dot.time)} s`,
        }),
      ),
    ];
    const svg = Plot.plot({
      width,
      ...(chart.equal ? { aspectRatio: 1 } : { height: Math.round(Math.min(330, Math.max(230, width * 0.62))) }),
      marginLeft: 58,
      marginBottom: 42,
      marginTop: 22,
      marginRight: 14,
      inset: 8,
      style: {
        background: "transparent",
        color: "var(--ink)",
        fontFamily: "inherit",
        fontSize: "12px",
        overflow: "visible",
      },
      x: { label: chart.x.label, labelAnchor: "center", labelArrow: "none", nice: false },
      y: { label: chart.y.label, labelAnchor: "center", labelArrow: "none" },
      ariaLabel: `${chart.title}: ${chart.y.label} against ${chart.x.label}`,
      marks,
    }) as Svg;
    svg.setAttribute("role", "img");
    svg.addEventListener("click", (event) => this.choose(event as MouseEvent));
    this.svg?.remove();
    this.svg = svg;
    this.ring = document.createElementNS("http://www.w3.org/2000/svg", "circle");
    this.ring.setAttribute("r", "5.5");
    this.ring.setAttribute("class", "here");
    svg.append(this.ring);
    this.holder.append(svg);
    this.follow();
  }

  /** Events as discs with their number of the caption, one above the other where they would coincide. */
  private markSigns(width: number): Plot.Markish[] {
    const dots = this.lines.flatMap((line) => line.dots);
    const span = (key: "x" | "y") =>
      Math.max(...dots.map((dot) => dot[key])) - Math.min(...dots.map((dot) => dot[key])) || 1;
    const across = width / span("x"),
      up = (0.6 * width) / span("y");
    const { marks } = this.chart;
    return marks.flatMap((mark, i) => {
      const lift = marks
        .slice(0, i)
        .filter((other) => Math.hypot((other.x - mark.x) * across, (other.y - mark.y) * up) < SIGN).length;
      const place = { x: "x", y: "y", dy: -1.1 * SIGN * lift };
      return [
        Plot.dot([mark], { ...place, r: SIGN / 2, fill: `var(--${mark.role})`, stroke: "var(--paper)" }),
        Plot.text([mark], {
          ...place,
          text: () => signOf(mark, i),
          fill: "var(--on-mark)",
          fontWeight: 700,
          fontSize: 10,
        }),
      ];
    });
  }

  private line(): Line | undefined {
    return this.lines.find(({ data }) => data.model === this.head.model.key) ?? this.lines[0];
  }

  private follow(): void {
    const line = this.line();
    if (!this.svg || !this.ring || !line) return;
    const model = this.run.models.find((candidate) => candidate.key === line.data.model);
    const x = this.svg.scale("x"),
      y = this.svg.scale("y");
    if (!model || !x || !y) return;
    const at = model.cursor(this.head.time);
    this.ring.setAttribute("cx", String(x.apply(shown(this.chart.x, model.value(line.data.x, at)))));
    this.ring.setAttribute("cy", String(y.apply(shown(this.chart.y, model.value(line.data.y, at)))));
  }

  /** Brings the replay to the point of the curve nearest to the pointer. */
  private choose(event: MouseEvent): void {
    const x = this.svg?.scale("x"),
      y = this.svg?.scale("y"),
      line = this.line();
    if (!this.svg || !x || !y || !line) return;
    const box = this.svg.getBoundingClientRect();
    const at = { x: event.clientX - box.left, y: event.clientY - box.top };
    let best: Dot | undefined,
      distance = Infinity;
    for (const dot of line.dots) {
      const far = Math.hypot(x.apply(dot.x) - at.x, y.apply(dot.y) - at.y);
      if (far < distance) [best, distance] = [dot, far];
    }
    if (best) this.head.change({ time: best.time });
  }
}

function axisValue(axis: AxisData, value: number): string {
  const name = axis.label.replace(/ \[[^\]]*\]$/, "");
  return `${name}: ${number(value)} ${axis.unit}`.trim();
}

function swatch(stroke: string, width: number, dash: string | undefined, label: string, opacity = 1): HTMLElement {
  const key = element("span", { class: "key" });
  key.innerHTML = `<svg width="30" height="10" aria-hidden="true"><line x1="3" x2="27" y1="5" y2="5" stroke-linecap="round"
    stroke="${stroke}" stroke-width="${width}" stroke-opacity="${opacity}" stroke-dasharray="${dash ?? "none"}"/></svg>`;
  key.append(label);
  return key;
}

function modelLegend(run: Run): HTMLElement {
  return element(
    "p",
    { class: "legend" },
    ...run.models.map((model) => {
      const style = STYLES[model.key]!;
      return swatch(style.stroke, style.width, style.dash, model.label);
    }),
  );
}

function energyLegend(chart: ChartData, run: Run): HTMLElement {
  const roles = [...new Set(chart.series.map((series) => series.style))];
  return element(
    "span",
    { class: "legend" },
    ...roles.map((role) => swatch(STYLES[role]!.stroke, 2.5, undefined, STYLES[role]!.label)),
    ...(run.models.length > 1
      ? [swatch("var(--quiet)", 5, undefined, "reduced", 0.35), swatch("var(--quiet)", 1.4, "6 3", "DEM")]
      : []),
  );
}

/** Fills the places for charts of a run. */
export function setUpCharts(run: Run, head: Playhead): void {
  for (const place of document.querySelectorAll<HTMLElement>(`.charts[data-run="${run.data.id}"]`)) {
    const energy = place.dataset["what"] === "energy";
    const charts = energy ? (run.data.energy ? [run.data.energy] : []) : run.data.charts;
    if (!energy) place.before(modelLegend(run));
    for (const chart of charts) place.append(new Chart(chart, run, head, energy).root);
  }
}
