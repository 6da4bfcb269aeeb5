// SPDX-License-Identifier: GPL-3.0-or-later
import { JointData, MeasureData, TrussData } from "./payload";

/** What drawing and ranking of a truss share: by what joints are ranked, which one is chosen. */
export class TrussState {
  measure: MeasureData | null;
  /** Places of joints in the file's order. */
  chosen: number | null = null;
  pointed: number | null = null;
  private readonly listeners: (() => void)[] = [];

  constructor(readonly data: TrussData) {
    this.measure = data.measures[0] ?? null;
  }

  listen(listener: () => void): void {
    this.listeners.push(listener);
  }

  change(change: Partial<Pick<TrussState, "measure" | "chosen" | "pointed">>): void {
    Object.assign(this, change);
    for (const listener of this.listeners) listener();
  }

  /** The joint whose numbers are told. */
  get told(): number | null {
    return this.pointed ?? this.chosen;
  }

  value(joint: JointData): number {
    return (this.measure && joint[this.measure.key]) ?? 0;
  }

  get largest(): number {
    return Math.max(0, ...this.data.joints.map((joint) => Math.abs(this.value(joint))));
  }

  /** Joints by rank. */
  get order(): number[] {
    const sizes = this.data.joints.map((joint) => Math.abs(this.value(joint)));
    return sizes.map((_, i) => i).sort((a, b) => sizes[b]! - sizes[a]! || a - b);
  }
}
