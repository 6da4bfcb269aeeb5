// SPDX-License-Identifier: GPL-3.0-or-later
// The truss as it was and with its magnified jumps, joints as dots as large as what they are ranked by.
import { choice, slider } from "./controls";
import { element, shape, short } from "./elements";
import { decoded, Samples, TrussData } from "./payload";
import { TrussState } from "./truss_state";

type Vector = [number, number, number];
interface View {
  key: string;
  label: string;
  right: Vector;
  up: Vector;
}

const turn = (Math.PI / 180) * -55,
  tilt = (Math.PI / 180) * 22;
const PLANE: View = { key: "xy", label: "plane x, y", right: [1, 0, 0], up: [0, 1, 0] };
const VIEWS: View[] = [
  {
    key: "oblique",
    label: "oblique",
    right: [-Math.sin(turn), Math.cos(turn), 0],
    up: [-Math.sin(tilt) * Math.cos(turn), -Math.sin(tilt) * Math.sin(turn), Math.cos(tilt)],
  },
  PLANE,
  { key: "xz", label: "plane x, z", right: [1, 0, 0], up: [0, 0, 1] },
  { key: "yz", label: "plane y, z", right: [0, 1, 0], up: [0, 0, 1] },
];
const MARGIN = 30; // pixels
const HIGHEST = 470;
const LOWEST = 110;
const BESIDE = 54; // pixels that the moved shape of a straight truss is drawn below the first
const STRAIGHT = 40; // pixels across below which a truss counts as straight
const BEYOND = 20; // how far the slider goes beyond the magnification to begin with
const NAMED = 5; // joints that have their rank beside them
const NAME = 15; // pixels that a rank takes
const MOST_GUIDED = 40; // nodes beyond which their marks would hide the truss
const MOST_APART = 400; // joints whose distances are looked at
const LARGEST_DOT = 12; // pixels
const SMALLEST_DOT = 4;
const STRETCHED = 0.2; // height over width below which a plane truss gets the whole width
const DENSE = 120; // links and springs beyond which lines are drawn thinner
const LEAST_JUMP = 0.03; // of the largest: shorter arrows are left out

/** 1, 2, 5, 10, ... up to a value. */
export function roundSteps(largest: number): number[] {
  const steps: number[] = [];
  for (let power = 1; power <= largest; power *= 10)
    for (const step of [1, 2, 5]) if (step * power <= largest) steps.push(step * power);
  return steps;
}

const thousands = (value: number) => String(value).replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f");
const LENGTHS: [number, string, number][] = [
  [1, "m", 1],
  [1e-3, "mm", 1e3],
  [1e-6, "µm", 1e6],
  [0, "nm", 1e9],
];

function length(value: number): string {
  const [, unit, factor] = LENGTHS.find(([least]) => value >= least * (1 - 1e-9))!;
  return `${short(value * factor, 3)}\u202f${unit}`;
}

export class TrussDrawing {
  readonly root: HTMLElement;
  private readonly holder: HTMLElement;
  private readonly start: Samples;
  private readonly cycles: Samples[];
  private readonly steps: number[];
  private readonly about = element("p", { class: "fine", "aria-live": "polite" });
  private cycle: number;
  private step: number;
  private view: View;

  constructor(
    private readonly state: TrussState,
    title: string,
  ) {
    const { data } = state;
    this.start = decoded(data.start, 3 * data.nodes.length);
    this.cycles = data.cycles.map(({ jump }) => decoded(jump, 3 * data.nodes.length));
    this.cycle = data.cycles.length - 1;
    this.view = data.dimension === 3 ? VIEWS[0]! : PLANE;
    this.steps = roundSteps(Math.max(10, BEYOND * data.magnification));
    this.step = Math.max(0, this.steps.indexOf(data.magnification));
    this.holder = element("div", {
      class: data.lines.length > DENSE ? "truss-drawing dense" : "truss-drawing",
      tabindex: 0,
      role: "group",
      "aria-label": `Drawing of ${title} with its jumps. Arrow keys go through the joints by rank, + and − magnify.`,
      keydown: (event: Event) => this.key(event as KeyboardEvent),
    });
    this.root = element("div", { class: "truss-figure" }, this.controls(), this.holder, legend(data), this.about);
    new ResizeObserver(() => this.draw()).observe(this.holder);
    state.listen(() => this.draw());
  }

  /** Whether the truss is so long and low that its drawing needs the whole width. */
  get stretched(): boolean {
    const places = this.flat(0);
    const [wide, tall] = [0, 1].map((axis) => {
      const values = places.map((place) => place[axis]!);
      return Math.max(...values) - Math.min(...values);
    });
    return tall! < STRETCHED * wide!;
  }

  get magnification(): number {
    return this.steps[this.step] ?? 1;
  }

  private controls(): HTMLElement {
    const { data } = this.state;
    const magnify = slider(
      "Jumps",
      (value) => {
        this.step = Math.round(value);
        this.draw();
      },
      this.steps.length - 1,
      1,
    );
    magnify.input.setAttribute("aria-label", "Magnification of the jumps");
    this.follow = () => {
      magnify.input.value = String(this.step);
      magnify.value.textContent = `× ${thousands(this.magnification)}`;
      magnify.input.setAttribute("aria-valuetext", `magnified ${this.magnification} times`);
    };
    const fields: HTMLElement[] = [];
    if (data.dimension === 3) {
      const views = choice(
        "View",
        VIEWS.map((view) => [view.key, view.label]),
        this.view.key,
        (key) => {
          this.view = VIEWS.find((view) => view.key === key) ?? VIEWS[0]!;
          this.draw();
        },
      );
      fields.push(views.field);
    }
    if (data.cycles.length > 1) {
      const cycles = choice(
        "After cycle",
        data.cycles.map(({ cycle }, i) => [String(i), String(cycle)]),
        String(this.cycle),
        (value) => {
          this.cycle = Number(value);
          this.draw();
        },
      );
      fields.push(cycles.field);
    }
    return element("div", { class: "truss-controls" }, magnify.row, ...fields);
  }

  private follow: () => void = () => undefined;

  /** Places of the nodes on the page's plane [m], the second upwards. */
  private flat(times: number): [number, number][] {
    const { right, up } = this.view,
      jump = this.cycles[this.cycle];
    return this.state.data.nodes.map((_, node) => {
      const at = [0, 1, 2].map((axis) => (this.start[3 * node + axis] ?? 0) + times * (jump?.[3 * node + axis] ?? 0));
      const along = (way: Vector) => way[0] * at[0]! + way[1] * at[1]! + way[2] * at[2]!;
      return [along(right), along(up)];
    });
  }

  private draw(): void {
    const width = Math.floor(this.holder.clientWidth);
    this.follow();
    if (width < 40) return;
    const { data } = this.state;
    const before = this.flat(0),
      after = this.flat(this.magnification);
    const all = [...before, ...after];
    const low = [0, 1].map((axis) => Math.min(...all.map((place) => place[axis]!)));
    const high = [0, 1].map((axis) => Math.max(...all.map((place) => place[axis]!)));
    const wide = Math.max(high[0]! - low[0]!, 1e-12),
      tall = high[1]! - low[1]!;
    const scale = Math.min((width - 2 * MARGIN) / wide, (HIGHEST - 2 * MARGIN) / Math.max(tall, 1e-12));
    const beside = tall * scale < STRAIGHT ? BESIDE : 0;
    const drawn = Math.max(LOWEST, tall * scale + beside + 2 * MARGIN),
      height = drawn + 26;
    const middle = [(low[0]! + high[0]!) / 2, (low[1]! + high[1]!) / 2];
    const onPage = ([x, y]: [number, number], down: number): [number, number] => [
      width / 2 + (x - middle[0]!) * scale,
      (drawn - beside) / 2 - (y - middle[1]!) * scale + down,
    ];
    const from = before.map((place) => onPage(place, 0)),
      moved = after.map((place) => onPage(place, beside));
    const picture = shape("svg", {
      width,
      height,
      viewBox: `0 0 ${width} ${height}`,
      role: "img",
      "aria-label": `Truss, jumps magnified ${this.magnification} times`,
    });
    picture.append(
      shape("path", { class: "as-built", d: linesOf(data, from) }),
      shape("path", { class: "held", d: data.held.map((node) => square(from[node]!, 4)).join("") }),
      shape("path", {
        class: "held guided",
        d: data.guided.length > MOST_GUIDED ? "" : data.guided.map((node) => square(from[node]!, 3)).join(""),
      }),
      shape("path", { class: "moved tied", d: linesOf(data, moved, "spring") }),
      shape("path", { class: "moved journal", d: linesOf(data, moved, "journal") }),
      shape("path", { class: "moved", d: linesOf(data, moved, "link") }),
      ...this.nodes(moved),
      ...this.joints(moved, [width / 2, (drawn + beside) / 2]),
      ...this.arrows(
        before.map((place) => onPage(place, beside)),
        moved,
      ),
      ...this.ruler(scale, width, height),
    );
    this.holder.replaceChildren(picture);
    this.holder.dataset["magnification"] = String(this.magnification);
    this.about.textContent =
      `Jumps after cycle ${data.cycles[this.cycle]?.cycle ?? 0} since the start, drawn ${thousands(this.magnification)} times as large as they are; ` +
      `the largest of all is ${length(data.largest_m)}.${beside ? " The moved truss is drawn below itself." : ""}`;
  }

  private arrows(from: [number, number][], to: [number, number][]): SVGElement[] {
    const jump = this.cycles[this.cycle];
    let shafts = "",
      heads = "";
    from.forEach(([x, y], node) => {
      const size = Math.hypot(...[0, 1, 2].map((axis) => jump?.[3 * node + axis] ?? 0));
      const [u, v] = to[node]!,
        long = Math.hypot(u - x, v - y);
      if (size < LEAST_JUMP * this.state.data.largest_m || long < 5) return;
      const head = Math.min(8, 0.6 * long),
        [a, b] = [(u - x) / long, (v - y) / long];
      shafts += `M${x.toFixed(1)},${y.toFixed(1)}L${(u - head * a).toFixed(1)},${(v - head * b).toFixed(1)}`;
      const corner = (side: number) =>
        `${(u - head * a - side * 0.42 * head * b).toFixed(1)},${(v - head * b + side * 0.42 * head * a).toFixed(1)}`;
      heads += `M${u.toFixed(1)},${v.toFixed(1)}L${corner(1)}L${corner(-1)}Z`;
    });
    return [shape("path", { class: "jump-shaft", d: shafts }), shape("path", { class: "jump-head", d: heads })];
  }

  private nodes(at: [number, number][]): SVGElement[] {
    const { data } = this.state;
    return at.map(([x, y], node) => {
      const dot = shape("circle", { class: "node", cx: x.toFixed(1), cy: y.toFixed(1), r: 5 });
      dot.append(shape("title", {}, `Node ${data.nodes[node]}: jump ${data.jumps[node]} at the end`));
      return dot;
    });
  }

  private joints(at: [number, number][], middle: [number, number]): SVGElement[] {
    const { data } = this.state,
      largest = this.state.largest,
      { order, told, chosen } = this.state;
    const apart = data.joints.length > MOST_APART ? 0 : spacing(data.joints.map((joint) => at[joint.node]!));
    const widest = Math.min(LARGEST_DOT, Math.max(SMALLEST_DOT, 0.5 * apart));
    const named: [number, number][] = [];
    const drawn = order.map((joint, rank) => {
      const found = data.joints[joint]!,
        value = this.state.value(found);
      const [x, y] = at[found.node]!;
      const radius = Math.max(2.2, widest * Math.sqrt(largest > 0 ? Math.abs(value) / largest : 0));
      const group = shape("g", {
        class: `joint ${value < 0 ? "against" : "with"}${joint === chosen ? " chosen" : ""}${joint === told ? " told" : ""}`,
        "data-joint": joint,
        transform: `translate(${x.toFixed(1)},${y.toFixed(1)})`,
      });
      group.append(
        shape("circle", { class: "hit", r: Math.max(radius, 10).toFixed(1) }),
        shape("circle", { class: "dot", r: radius.toFixed(1) }),
      );
      if (joint === told) group.append(shape("circle", { class: "halo", r: (radius + 5).toFixed(1) }));
      const free = !named.some(([u, v]) => Math.hypot(u - x, v - y) < NAME);
      if ((rank < NAMED && free) || joint === told) {
        named.push([x, y]);
        const away = Math.hypot(x - middle[0], y - middle[1]) || 1;
        const reach = radius + (joint === told ? 16 : 10);
        group.append(
          shape(
            "text",
            {
              x: ((reach * (x - middle[0])) / away).toFixed(1),
              y: (away > 1 ? (reach * (y - middle[1])) / away : -reach).toFixed(1),
              dy: "0.35em",
              "text-anchor":
                joint !== told ? "middle" : x > middle[0] + 20 ? "start" : x < middle[0] - 20 ? "end" : "middle",
            },
            joint === told ? found.name : String(rank + 1),
          ),
        );
      }
      group.addEventListener(
        "pointerenter",
        () => this.state.pointed !== joint && this.state.change({ pointed: joint }),
      );
      group.addEventListener("click", () =>
        this.state.change({ chosen: joint === chosen ? null : joint, pointed: null }),
      );
      return group;
    });
    // Small dots above large ones, what is told above all.
    return drawn.sort((a, b) => Number(a.classList.contains("told")) - Number(b.classList.contains("told")));
  }

  /** A length of the truss, and what it is of a jump. */
  private ruler(scale: number, width: number, height: number): SVGElement[] {
    const wanted = (0.28 * width) / scale;
    const power = 10 ** Math.floor(Math.log10(wanted));
    const real = power * Math.max(...[1, 2, 5].filter((step) => step * power <= wanted * (1 + 1e-9)));
    const left = 8,
      right = left + real * scale,
      y = height - 9;
    return [
      shape("path", {
        class: "ruler",
        d: `M${left},${y - 4}V${y + 4}M${left},${y}H${right.toFixed(1)}M${right.toFixed(1)},${y - 4}V${y + 4}`,
      }),
      shape(
        "text",
        { class: "ruler-text", x: (right + 8).toFixed(1), y, dy: "0.35em" },
        `${length(real)}, of a jump ${length(real / this.magnification)}`,
      ),
    ];
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const { order, chosen } = this.state;
    const go = (by: number) => {
      const rank = chosen === null ? (by > 0 ? -1 : 0) : order.indexOf(chosen);
      if (order.length) this.state.change({ chosen: order[(rank + by + order.length) % order.length]!, pointed: null });
    };
    const magnify = (by: number) => {
      this.step = Math.min(this.steps.length - 1, Math.max(0, this.step + by));
      this.draw();
    };
    const actions: Record<string, () => void> = {
      ArrowRight: () => go(1),
      ArrowDown: () => go(1),
      ArrowLeft: () => go(-1),
      ArrowUp: () => go(-1),
      Escape: () => this.state.change({ chosen: null, pointed: null }),
      "+": () => magnify(1),
      "=": () => magnify(1),
      "-": () => magnify(-1),
      "−": () => magnify(-1),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }
}

function linesOf(data: TrussData, at: [number, number][], kind = ""): string {
  return data.lines
    .filter((line) => !kind || line.kind === kind)
    .map(({ nodes: [one, two] }) => {
      const [x, y] = at[one]!,
        [u, v] = at[two]!;
      return `M${x.toFixed(1)},${y.toFixed(1)}L${u.toFixed(1)},${v.toFixed(1)}`;
    })
    .join("");
}

const square = ([x, y]: [number, number], half: number) =>
  `M${(x - half).toFixed(1)},${(y - half).toFixed(1)}h${2 * half}v${2 * half}h${-2 * half}Z`;

/** Distance within which half of the places have another one. */
function spacing(places: [number, number][]): number {
  const nearest = places.map(([x, y], i) =>
    Math.min(Infinity, ...places.map(([u, v], j) => (i === j ? Infinity : Math.hypot(u - x, v - y)))),
  );
  return nearest.sort((a, b) => a - b)[nearest.length >> 1] ?? Infinity;
}

function key(picture: string, text: string): HTMLElement {
  const made = element("span", { class: "key" });
  made.innerHTML = `<svg width="26" height="14" aria-hidden="true">${picture}</svg>`;
  made.append(text);
  return made;
}

function legend(data: TrussData): HTMLElement {
  const signed = data.measures.some((measure) => measure.signed);
  const dot = (kind: string) => `<g class="joint ${kind}" transform="translate(13,7)"><circle class="dot" r="5"/></g>`;
  return element(
    "p",
    { class: "legend" },
    key('<path class="as-built" d="M2,7H24"/>', "before the first cycle"),
    key('<path class="moved" d="M2,7H24"/>', "after the cycle"),
    ...(data.lines.some((line) => line.kind === "spring")
      ? [key('<path class="moved tied" d="M2,7H24"/>', "spring or cable")]
      : []),
    ...(data.lines.some((line) => line.kind === "journal")
      ? [key('<path class="moved journal" d="M2,7H24"/>', "journal to its bearing")]
      : []),
    key('<path class="jump-shaft" d="M2,7H16"/><path class="jump-head" d="M24,7L16,3.5V10.5Z"/>', "jump of a node"),
    key('<path class="held" d="M9,3h8v8h-8Z"/>', "held"),
    ...(data.guided.length && data.guided.length <= MOST_GUIDED
      ? [key('<path class="held guided" d="M10,4h6v6h-6Z"/>', "guided")]
      : []),
    ...(data.joints.length
      ? signed
        ? [key(dot("with"), "joint, acts with the jump"), key(dot("against"), "against it")]
        : [key(dot("with"), "joint")]
      : []),
  );
}
