// SPDX-License-Identifier: GPL-3.0-or-later
// The ranking of a truss' joints beside its drawing; choosing a joint in one shows it in the other.
import { choice } from "./controls";
import { element } from "./elements";
import { JointData, Run } from "./payload";
import { TrussDrawing } from "./truss_drawing";
import { TrussState } from "./truss_state";

/** What is known of a joint, in words. */
function told(state: TrussState, place: number | null): string {
  const joint = place === null ? undefined : state.data.joints[place];
  if (!joint) return "Choose a joint to see its numbers and where it is.";
  const { text } = joint;
  const parts = [
    text["contribution"] ? `contribution ${text["contribution"]}, ${text["share"]} of the jump` : "",
    text["jump"] ? `jump of the joint ${text["jump"]}` : "",
    text["turn"] ? `turned by ${text["turn"]}` : "",
    text["heat"]
      ? `heat ${text["heat"]}${text["heat_of_cycle"] ? `, ${text["heat_of_cycle"]} in the last cycle` : ""}`
      : "",
  ].filter(Boolean);
  const rank = state.order.indexOf(place!) + 1;
  return `${joint.name}, ${joint.called} at node ${state.data.nodes[joint.node]}, rank ${rank} of ${state.data.joints.length}: ${parts.join("; ")}.`;
}

/** Bars of the joints that come first. */
class Ranking {
  readonly root: HTMLElement;
  private readonly list = element("ol", { class: "ranks" });
  private readonly numbers = element("p", { class: "told", role: "status" });
  private readonly note = element("p", { class: "fine" });
  private readonly more = element("p", { class: "fine" });
  private drawn: unknown = undefined; // no measure is null: drawn as well

  constructor(private readonly state: TrussState) {
    const { measures } = state.data;
    const head = element("div", { class: "rank-head" });
    if (measures.length > 1) {
      head.append(
        choice(
          "Joints ranked by",
          measures.map((measure) => [measure.key, measure.label.toLowerCase()]),
          state.measure?.key ?? "",
          (key) => state.change({ measure: measures.find((measure) => measure.key === key) ?? null }),
        ).field,
      );
    } else if (measures[0]) head.append(element("strong", {}, `Joints ranked by ${measures[0].label.toLowerCase()}`));
    this.root = element("div", { class: "truss-ranking" }, head, this.list, this.more, this.numbers, this.note);
    this.list.addEventListener("pointerleave", () => state.change({ pointed: null }));
    state.listen(() => this.update());
    this.update();
  }

  private update(): void {
    const { state } = this;
    if (this.drawn !== state.measure) this.fill();
    for (const row of this.list.querySelectorAll<HTMLElement>("button")) {
      const place = Number(row.dataset["joint"]);
      row.setAttribute("aria-pressed", String(place === state.chosen));
      row.classList.toggle("told", place === state.told);
    }
    this.numbers.textContent = state.measure ? told(state, state.told) : "";
  }

  private fill(): void {
    const { state } = this,
      { data, measure } = state;
    this.drawn = measure;
    if (!measure) {
      this.list.replaceChildren();
      this.note.textContent = data.joints.length
        ? "No joint moved."
        : "This truss has no joints with friction or clearance.";
      return;
    }
    const values = data.joints.map((joint) => state.value(joint));
    const low = Math.min(0, ...values),
      span = Math.max(0, ...values) - low || 1;
    const hottest = Math.max(0, ...data.joints.map((joint) => joint.heat ?? 0));
    const shown = state.order.slice(0, data.most);
    this.list.replaceChildren(
      ...shown.map((place, i) => this.row(place, i + 1, (-100 * low) / span, 100 / span, hottest)),
    );
    const more = data.joints.length - shown.length;
    this.more.textContent = more > 0 ? `${more} more in the file and in the drawing.` : "";
    this.more.hidden = more <= 0;
    this.note.textContent =
      measure.note +
      (measure.key !== "heat" && hottest > 0 ? " The thin bar is the heat of friction, of the hottest joint's." : "");
  }

  private row(place: number, rank: number, zero: number, scale: number, hottest: number): HTMLElement {
    const { state } = this,
      joint = state.data.joints[place] as JointData,
      value = state.value(joint);
    const width = Math.abs(value) * scale,
      left = value < 0 ? zero - width : zero;
    const bars = element(
      "span",
      { class: "bars", "aria-hidden": "true" },
      element("i", { class: "zero", style: `left:${zero}%` }),
      element("i", { class: value < 0 ? "against" : "with", style: `left:${left}%;width:${width}%` }),
    );
    if (state.measure?.key !== "heat" && hottest > 0)
      bars.append(
        element("i", { class: "heat", style: `left:${zero}%;width:${((joint.heat ?? 0) / hottest) * (100 - zero)}%` }),
      );
    const { text } = joint,
      own = state.measure ? (text[`${state.measure.key}_short`] ?? "") : "";
    const button = element(
      "button",
      {
        type: "button",
        "data-joint": place,
        "aria-pressed": "false",
        title: told(state, place),
        click: () => state.change({ chosen: state.chosen === place ? null : place, pointed: null }),
        pointerenter: () => state.change({ pointed: place }),
        focus: () => state.change({ pointed: place }),
        blur: () => state.change({ pointed: null }),
      },
      element("span", { class: "rank" }, String(rank)),
      element("span", { class: "rank-name" }, joint.name),
      bars,
      element(
        "span",
        { class: "rank-value" },
        ...(state.measure?.key === "contribution" && text["share"]
          ? [element("b", {}, text["share"]), ` ${own}`]
          : [element("b", {}, own)]),
      ),
    );
    return element("li", {}, button);
  }
}

/** Fills the place of a truss' drawing and ranking. */
export function setUpTruss(run: Run): void {
  const place = document.querySelector<HTMLElement>(`.truss[data-run="${run.data.id}"]`);
  if (!place || !run.data.truss) return;
  const state = new TrussState(run.data.truss);
  const drawing = new TrussDrawing(state, run.data.title);
  drawing.root.addEventListener("pointerleave", () => state.change({ pointed: null }));
  place.classList.toggle("stretched", drawing.stretched);
  place.append(drawing.root, new Ranking(state).root);
}
