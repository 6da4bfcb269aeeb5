// SPDX-License-Identifier: GPL-3.0-or-later
// Controls of the replay and of the drawings: label, control, value.
import { element } from "./elements";

export const STEPS = 1000; // of a slider without steps of its own

let count = 0;

/** A slider with its label and the value beside it. */
export function slider(
  label: string,
  input: (value: number) => void,
  most = STEPS,
  step: number | "any" = "any",
): { row: HTMLElement; input: HTMLInputElement; value: HTMLOutputElement } {
  const id = `slider${++count}`;
  const made = element("input", {
    type: "range",
    id,
    min: 0,
    max: most,
    step,
    input: () => input(Number(made.value)),
  });
  const value = element("output", { for: id });
  return {
    row: element("div", { class: "slide" }, element("label", { for: id }, label), made, value),
    input: made,
    value,
  };
}

/** A choice of one of several, with its label. */
export function choice(
  label: string,
  options: [string, string][],
  chosen: string,
  change: (value: string) => void,
): { field: HTMLElement; select: HTMLSelectElement } {
  const select = element(
    "select",
    { change: () => change(select.value) },
    ...options.map(([value, text]) => element("option", { value, selected: value === chosen }, text)),
  );
  return { field: element("label", { class: "field" }, element("span", {}, label), select), select };
}

/** A box to tick, with its label. */
export function box(
  label: string,
  checked: boolean,
  change: (on: boolean) => void,
): { field: HTMLElement; input: HTMLInputElement } {
  const input = element("input", { type: "checkbox", checked, change: () => change(input.checked) });
  return { field: element("label", { class: "check" }, input, label), input };
}
