// SPDX-License-Identifier: GPL-3.0-or-later
import { box, choice, slider, STEPS } from "./controls";
import { element, number, short } from "./elements";
import { FORCE_KINDS } from "./arrows";
import { Run } from "./payload";
import { Ghost, Playhead } from "./playhead";
import { SceneView, View, VIEWS } from "./scene";
import { swatchOf } from "./strips";
import { onTheme } from "./theme";

const LARGEST_MAGNIFICATION = 1000;
const VIEW_NAMES: Record<View, string> = { oblique: "Oblique", front: "Front", top: "Top", joint: "Joint" };
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const GHOSTS: Record<Ghost, string> = { start: "the start", other: "the other model", none: "nothing" };
const KEYS: [string, string][] = [
  ["Space", "play, pause"],
  ["← →", "one step back, on"],
  ["Shift + ← →", "event before, after"],
  ["Home, End", "start, end"],
  ["+ −", "magnification"],
  ["1 2 3 4", "views: oblique, front, top, joint; 4 again: next joint"],
  ["Z, Shift + Z", "zoom in, out"],
  ["M", "other model"],
  ["G", "what stands behind as a ghost"],
  ["F, L", "forces, labels on and off"],
];

/** Sliders of magnification are logarithmic: from 1 to the largest. */
const fromSlider = (value: number) =>
  Number(Math.exp((value / STEPS) * Math.log(LARGEST_MAGNIFICATION)).toPrecision(2));
const toSlider = (magnification: number) => (STEPS * Math.log(magnification)) / Math.log(LARGEST_MAGNIFICATION);

/** Whether the browser draws in three dimensions; asked first, as a refusal inside three.js is loud. */
function hasWebGL(): boolean {
  return document.createElement("canvas").getContext("webgl2") !== null;
}

/** Replay of a run: picture, sliders, keys. */
class Player {
  private readonly stage = element("div", { class: "stage" });
  private readonly root: HTMLElement;
  private readonly updates: (() => void)[] = [];
  private view: SceneView | null = null;
  private failed = false;
  private readonly events: number[];

  constructor(
    place: HTMLElement,
    private readonly run: Run,
    private readonly head: Playhead,
  ) {
    const { data } = run;
    this.events = [
      ...new Set([
        0,
        ...Array.from(document.querySelectorAll<HTMLElement>(`#${data.id} .events [data-time]`), (row) =>
          Number(row.dataset["time"]),
        ),
        head.end,
      ]),
    ].sort((a, b) => a - b);
    this.root = element(
      "div",
      {
        class: "player",
        role: "group",
        tabindex: 0,
        "aria-label": `Replay of ${data.title}. Keys are listed below it.`,
      },
      this.stageWithTools(),
      this.legend(),
      this.times(),
      this.controls(),
      this.readouts(),
      this.explanation(),
    );
    place.replaceChildren(this.root);
    this.root.addEventListener("keydown", (event) => this.key(event));
    head.listen(() => this.update());
    onTheme(() => this.view?.theme());
    this.update();
  }

  /** Makes the picture when it comes into sight, drops it when others need the memory. */
  show(): void {
    if (this.view || this.failed) return;
    this.failed = !hasWebGL();
    if (!this.failed) {
      this.view = new SceneView(this.stage, this.run, this.head);
    } else {
      this.root.classList.add("without");
      this.stage.replaceChildren(
        element(
          "p",
          { class: "note", role: "status" },
          "No 3-D picture: this browser offers no WebGL. The sliders still move the marks in the charts; charts, numbers and tables are complete without the picture.",
        ),
      );
    }
  }

  hide(): void {
    this.view?.dispose();
    this.view = null;
  }

  get visible(): boolean {
    return this.view !== null;
  }
  get target(): Element {
    return this.root;
  }

  private stageWithTools(): HTMLElement {
    const views = VIEWS.map((view) =>
      element("button", { type: "button", click: () => this.view?.choose(view) }, VIEW_NAMES[view]),
    );
    const zooms = [
      ["+", 1.25, "Zoom in"],
      ["−", 0.8, "Zoom out"],
    ] as const;
    return element(
      "div",
      { class: "stage-frame" },
      this.stage,
      element(
        "div",
        { class: "tools", role: "group", "aria-label": "Views" },
        ...views,
        ...zooms.map(([text, factor, label]) =>
          element("button", { type: "button", "aria-label": label, click: () => this.view?.zoom(factor) }, text),
        ),
      ),
    );
  }

  private legend(): HTMLElement {
    const { scene } = this.run.data;
    const used = new Set(
      scene.contacts.flatMap((contact) =>
        this.run.models.flatMap((model) => Array.from(model.column(contact.state) ?? [])),
      ),
    );
    const kinds = [...new Set(scene.forces.map((force) => force.kind))];
    return element(
      "p",
      { class: "legend" },
      ...scene.states.flatMap((state, i) =>
        used.has(i) ? [element("span", { class: "key" }, swatchOf(state.colour, i === 0), state.label)] : [],
      ),
      ...kinds.map((kind) =>
        element(
          "span",
          { class: "key" },
          element(
            "b",
            { class: "arrow", "aria-hidden": "true", style: `color:var(--${FORCE_KINDS[kind] ?? "force-external"})` },
            "➞",
          ),
          `${kind} force`,
        ),
      ),
    );
  }

  private times(): HTMLElement {
    const { head } = this;
    const play = element("button", { type: "button", class: "play", click: () => head.play() });
    const time = slider("Time", (value) => head.change({ time: (value / STEPS) * head.end }));
    const temperature = slider("ΔT", (value) => {
      const [low, high] = this.temperatures();
      head.seekTemperature(low + (value / STEPS) * (high - low));
    });
    temperature.input.setAttribute("aria-label", "Temperature change");
    this.updates.push(() => {
      play.textContent = head.playing ? "❚❚" : "▶";
      play.setAttribute("aria-label", head.playing ? "Pause" : "Play");
      const at = head.model.cursor(head.time),
        change = head.model.value("temperature_change_K", at);
      const [low, high] = this.temperatures();
      time.input.value = String((head.time / head.end) * STEPS);
      time.value.textContent = `${number(head.time)} s`;
      temperature.input.value = String(high > low ? ((change - low) / (high - low)) * STEPS : 0);
      temperature.value.textContent = `${number(change)} K ${this.trend()}`;
      time.input.setAttribute("aria-valuetext", time.value.textContent);
      temperature.input.setAttribute("aria-valuetext", temperature.value.textContent);
      this.root.dataset["time"] = String(head.time);
      this.root.dataset["temperature"] = String(change);
    });
    const speed = choice(
      "Speed",
      SPEEDS.map((value) => [String(value), `${value} ×`]),
      "1",
      (value) => head.change({ speed: Number(value) }),
    );
    return element(
      "div",
      { class: "times" },
      play,
      element("div", { class: "slides" }, time.row, temperature.row),
      speed.field,
    );
  }

  private trend(): string {
    const values = this.head.model.column("temperature_change_K"),
      { index } = this.head.model.cursor(this.head.time);
    const step = (values?.[index + 1] ?? 0) - (values?.[index] ?? 0);
    return step > 0 ? "↑" : step < 0 ? "↓" : "";
  }

  private temperatures(): [number, number] {
    const values = this.head.model.column("temperature_change_K");
    let low = Infinity,
      high = -Infinity;
    for (const value of values ?? [0]) [low, high] = [Math.min(low, value), Math.max(high, value)];
    return [low, high];
  }

  private controls(): HTMLElement {
    const { head, run } = this,
      { scene } = run.data;
    const clearance = slider("Clearance", (value) => head.change({ clearance: fromSlider(value) }));
    const plays = scene.clearance_m > 0 || !scene.deforms;
    const rows = plays ? [clearance.row] : [];
    const fields: HTMLElement[] = [];
    const shown: [typeof clearance, () => number, string][] = [[clearance, () => head.clearance, "clearance"]];
    if (scene.deforms) {
      const deformation = slider("Deformation", (value) => head.change({ deformation: fromSlider(value) }));
      rows.push(deformation.row);
      shown.push([deformation, () => head.deformation, "deformation"]);
      if (plays)
        fields.push(
          box("magnify both alike", head.together, (on) => head.change({ together: on, clearance: head.clearance }))
            .field,
        );
    }
    if (run.models.length > 1) {
      const models = choice(
        "Model",
        run.models.map((model) => [model.key, model.label]),
        head.model.key,
        (key) => {
          const model = run.models.find((candidate) => candidate.key === key);
          if (model) head.change({ model });
        },
      );
      this.updates.push(() => {
        models.select.value = head.model.key;
      });
      fields.push(models.field);
    }
    const ghosts = choice(
      "Behind it",
      (Object.entries(GHOSTS) as [Ghost, string][]).filter(([key]) => key !== "other" || run.models.length > 1),
      head.ghost,
      (ghost) => head.change({ ghost: ghost as Ghost }),
    );
    const forces = box("forces", head.forces, (on) => head.change({ forces: on }));
    const labels = box("labels", head.labels, (on) => head.change({ labels: on }));
    fields.push(ghosts.field, forces.field, labels.field);
    this.updates.push(() => {
      for (const [row, value, name] of shown) {
        row.input.value = String(toSlider(value()));
        row.value.textContent = `× ${short(value())}`;
        row.input.setAttribute("aria-valuetext", `magnified ${short(value())} times`);
        this.root.dataset[name] = String(value());
      }
      ghosts.select.value = head.ghost;
      forces.input.checked = head.forces;
      labels.input.checked = head.labels;
    });
    return element(
      "div",
      { class: "settings" },
      element("div", { class: "slides" }, ...rows),
      element("div", { class: "fields" }, ...fields),
    );
  }

  private readouts(): HTMLElement {
    const { head, run } = this;
    const list = element("dl", { class: "readouts" });
    for (const readout of run.data.readouts) {
      const value = element("dd");
      list.append(element("div", {}, element("dt", {}, readout.label), value));
      this.updates.push(() => {
        const now = (head.model.value(readout.column, head.model.cursor(head.time)) - readout.start) * readout.scale;
        value.textContent = `${number(now)}\u202f${readout.unit}`;
      });
    }
    const stage = element("dd");
    if (run.data.stages.length) {
      list.append(element("div", {}, element("dt", {}, "Stage"), stage));
      this.updates.push(() => {
        const now =
          run.data.stages.find((candidate) => head.time <= candidate.end_s) ??
          run.data.stages[run.data.stages.length - 1];
        stage.textContent = now ? now.name : "";
        stage.title = now?.meaning ?? "";
      });
    }
    return list;
  }

  private explanation(): HTMLElement {
    const { scene } = this.run.data,
      gap = short(1e3 * scene.clearance_m);
    const text = element("p", { class: "fine" });
    this.updates.push(() => {
      const { head } = this;
      text.textContent = [
        scene.clearance_m > 0
          ? `Magnified: the place of a journal in its bearing or of a block in its slot, and the clearance itself, ${short(head.clearance)} times; the smallest clearance, ${gap}\u202fmm, is drawn as ${short(1e3 * scene.clearance_m * head.clearance)}\u202fmm.`
          : "",
        scene.deforms
          ? `The way of the links from where they started is magnified ${short(head.deformation)} times.`
          : "",
        "Lengths, radii and widths are not magnified; a link is drawn between the drawn places of its ends. Very thin links are drawn thicker.",
        scene.forces.length
          ? `The length of an arrow grows with the square root of the force; the longest is ${short(scene.largest_force_N)}\u202fN.`
          : "",
      ]
        .filter(Boolean)
        .join(" ");
    });
    return element(
      "div",
      { class: "about" },
      text,
      element(
        "details",
        {},
        element("summary", {}, "Keys"),
        element(
          "p",
          { class: "fine" },
          "While the replay has the focus (choose the picture, or come with Tab). Drag turns, two fingers or the right button move, Ctrl and wheel zoom.",
        ),
        element(
          "dl",
          { class: "keys" },
          ...KEYS.map(([keys, what]) =>
            element("div", {}, element("dt", {}, element("kbd", {}, keys)), element("dd", {}, what)),
          ),
        ),
      ),
    );
  }

  private update(): void {
    for (const update of this.updates) update();
  }

  private nextEvent(direction: number): number {
    const margin = 1e-9 * this.head.end,
      { time } = this.head;
    const found =
      direction > 0
        ? this.events.find((event) => event > time + margin)
        : [...this.events].reverse().find((event) => event < time - margin);
    return found ?? time;
  }

  private magnify(factor: number): void {
    const next = (now: number) => Math.min(LARGEST_MAGNIFICATION, Math.max(1, Number((now * factor).toPrecision(2))));
    const { together, clearance, deformation } = this.head;
    this.head.change(
      together ? { clearance: next(clearance) } : { clearance: next(clearance), deformation: next(deformation) },
    );
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const tag = (event.target as HTMLElement).tagName,
      { head } = this;
    const typed = (event.target as HTMLInputElement).type;
    if (
      tag === "SELECT" ||
      tag === "SUMMARY" ||
      ((tag === "BUTTON" || typed === "checkbox") && (event.key === " " || event.key === "Enter"))
    )
      return;
    if (typed === "range" && /^(Arrow|Home|End|Page)/.test(event.key)) return;
    const step = head.end / 200,
      models = this.run.models;
    const ghosts = (Object.keys(GHOSTS) as Ghost[]).filter((ghost) => ghost !== "other" || models.length > 1);
    const actions: Record<string, () => void> = {
      " ": () => head.play(),
      k: () => head.play(),
      ArrowRight: () => head.change({ time: event.shiftKey ? this.nextEvent(1) : head.time + step }),
      ArrowLeft: () => head.change({ time: event.shiftKey ? this.nextEvent(-1) : head.time - step }),
      Home: () => head.change({ time: 0 }),
      End: () => head.change({ time: head.end }),
      "+": () => this.magnify(1.25),
      "=": () => this.magnify(1.25),
      "-": () => this.magnify(0.8),
      "−": () => this.magnify(0.8),
      z: () => this.view?.zoom(event.shiftKey ? 0.8 : 1.25),
      m: () => head.change({ model: models[(models.indexOf(head.model) + 1) % models.length]! }),
      g: () => head.change({ ghost: ghosts[(ghosts.indexOf(head.ghost) + 1) % ghosts.length]! }),
      f: () => head.change({ forces: !head.forces }),
      l: () => head.change({ labels: !head.labels }),
    };
    VIEWS.forEach((view, i) => {
      actions[String(i + 1)] = () => this.view?.choose(view);
    });
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }
}

// Browsers keep some 16 WebGL contexts; a page of many runs has more replays.
const MOST_VIEWS = 4;

/** Makes the replays; their pictures as they come into sight. */
export function setUpPlayers(runs: Run[], heads: Playhead[]): void {
  const players = runs.flatMap((run, i) => {
    const place = document.querySelector<HTMLElement>(`.replay[data-run="${run.data.id}"]`),
      head = heads[i];
    return place && head ? [new Player(place, run, head)] : [];
  });
  const shown: Player[] = [];
  const watch = new IntersectionObserver(
    (entries) => {
      for (const entry of entries) {
        const player = players.find((candidate) => candidate.target === entry.target);
        if (!player || !entry.isIntersecting || player.visible) continue;
        player.show();
        shown.push(player);
        if (shown.length > MOST_VIEWS) shown.shift()?.hide();
      }
    },
    { rootMargin: "200px" },
  );
  for (const player of players) watch.observe(player.target);
}
