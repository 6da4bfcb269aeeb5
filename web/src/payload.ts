// SPDX-License-Identifier: GPL-3.0-or-later
// The data in the page, as document.py writes it, and its columns decoded.
import type { CampaignData } from "./campaign";

/** A column: the same number everywhere, or base64 of little-endian float32 (f) or uint8 (u). */
export type Encoded = number | { f: string } | { u: string };
/** A number, or the name of a column that holds it over the samples. */
export type Varying = number | string;

export interface AxisData {
  column: string;
  label: string;
  unit: string;
  scale: number;
  start: number;
}
export interface MarkData {
  time_s: number;
  label: string;
  value: string;
  role: "event" | "jump";
  x: number;
  y: number;
}
export interface SeriesData {
  model: string;
  x: string;
  y: string;
  style: string;
}
export interface ChartData {
  title: string;
  x: AxisData;
  y: AxisData;
  equal: boolean;
  stages: boolean;
  marks: MarkData[];
  rings: number[];
  series: SeriesData[];
}
export interface StageData {
  name: string;
  meaning: string;
  start_s: number;
  end_s: number;
}
export interface PointData {
  at: [Varying, Varying, Varying];
  of?: number;
}
export interface PartData {
  name: string;
  label: string;
  type: string;
  points: number[];
  angle?: Varying;
  width_m?: number;
  radius_m?: number;
  inner_m?: number;
  clearance?: Varying;
  axis?: [number, number, number];
  half_width_m?: number;
  half_height_m?: number;
  inner_minus_m?: number;
  inner_plus_m?: number;
  clearance_minus?: Varying;
  clearance_plus?: Varying;
  vertices?: Encoded;
  triangles?: Encoded;
}
export interface ContactData {
  name: string;
  label: string;
  on: number;
  from: number;
  state: string;
  gap: string;
}
export interface ForceData {
  label: string;
  kind: string;
  point: number;
  arm: [Varying, Varying, Varying];
  /** Three components, or one along the link from the point `from`. */
  vector: Varying[];
  from?: number;
  axis?: [number, number, number];
}
export interface SceneData {
  points: PointData[];
  parts: PartData[];
  contacts: ContactData[];
  forces: ForceData[];
  states: { label: string; colour: string }[];
  low: number[];
  high: number[];
  largest_force_N: number;
  clearance_m: number;
  shortest_link_m: number;
  magnification: number;
  magnification_of_deformation: number;
  deforms: boolean;
}
export interface ReadoutData {
  column: string;
  label: string;
  scale: number;
  start: number;
  unit: string;
}
export interface JointData {
  name: string;
  kind: string;
  /** The kind in words. */
  called: string;
  node: number;
  jump?: number;
  turn?: number;
  heat?: number;
  contribution?: number;
  /** Numbers with units: of the measures, of the share, of the heat in the last cycle. */
  text: Record<string, string>;
}
export interface MeasureData {
  key: "contribution" | "heat" | "jump" | "turn";
  label: string;
  note: string;
  signed: boolean;
  scale: number;
  unit: string;
}
export interface TrussData {
  dimension: number;
  nodes: string[];
  start: Encoded;
  lines: { nodes: [number, number]; kind: string; name: string }[];
  held: number[];
  guided: number[];
  cycles: { cycle: number; jump: Encoded }[];
  jumps: string[];
  largest_m: number;
  magnification: number;
  joints: JointData[];
  measures: MeasureData[];
  most: number;
}
export interface RunData {
  id: string;
  title: string;
  models: { key: string; label: string; columns: Record<string, Encoded> }[];
  charts: ChartData[];
  energy: ChartData | null;
  stages: StageData[];
  readouts: ReadoutData[];
  scene: SceneData;
  truss: TrussData | null;
}

export type Samples = Float32Array | Uint8Array;

function bytes(text: string): Uint8Array {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

/** Returns the values of a column of many samples; a constant one is filled up. */
export function decoded(column: Encoded, samples: number): Samples {
  if (typeof column === "number") return new Float32Array(samples).fill(column);
  if ("u" in column) return bytes(column.u);
  return new Float32Array(bytes(column.f).buffer);
}

/** Between which samples a time lies, and how far from the first to the second. */
export interface Cursor {
  index: number;
  fraction: number;
}

/** The history of one model. */
export class Model {
  readonly key: string;
  readonly label: string;
  readonly time: Samples;
  private readonly columns = new Map<string, Samples>();

  constructor(data: RunData["models"][number]) {
    this.key = data.key;
    this.label = data.label;
    this.time = decoded(data.columns["time_s"] ?? 0, 1);
    for (const [name, column] of Object.entries(data.columns))
      this.columns.set(name, decoded(column, this.time.length));
  }

  get end(): number {
    return this.time[this.time.length - 1] ?? 0;
  }

  column(name: string): Samples | undefined {
    return this.columns.get(name);
  }

  cursor(time: number): Cursor {
    let low = 0,
      high = this.time.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if ((this.time[middle] ?? 0) <= time) low = middle;
      else high = middle;
    }
    const start = this.time[low] ?? 0,
      step = (this.time[high] ?? 0) - start;
    return { index: low, fraction: step > 0 ? Math.min(1, Math.max(0, (time - start) / step)) : 0 };
  }

  /** Value at a cursor, straight between the samples. */
  value(what: Varying | undefined, at: Cursor): number {
    if (typeof what !== "string") return what ?? 0;
    const values = this.columns.get(what);
    if (!values) return 0;
    const first = values[at.index] ?? 0,
      second = values[at.index + 1] ?? first;
    return first + at.fraction * (second - first);
  }

  /** Value of a column of whole numbers: that of the nearer sample. */
  nearest(name: string, at: Cursor): number {
    const values = this.columns.get(name);
    return values?.[at.fraction > 0.5 ? at.index + 1 : at.index] ?? 0;
  }
}

/** A run with its histories decoded. */
export interface Run {
  data: RunData;
  models: Model[];
}

/** What the page holds: runs with their histories decoded, campaigns as they are. */
export function loadPage(): { runs: Run[]; campaigns: CampaignData[] } {
  const text = document.getElementById("data")?.textContent ?? '{"runs":[],"campaigns":[]}';
  const { runs, campaigns } = JSON.parse(text) as { runs: RunData[]; campaigns: CampaignData[] };
  return { runs: runs.map((data) => ({ data, models: data.models.map((model) => new Model(model)) })), campaigns };
}
