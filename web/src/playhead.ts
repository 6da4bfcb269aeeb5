// SPDX-License-Identifier: GPL-3.0-or-later
import { Model, Run } from "./payload";

export type Ghost = "none" | "start" | "other";

/** What the views of one run share: where the replay stands and what it shows. */
export class Playhead {
  time = 0;
  playing = false;
  speed = 1;
  model: Model;
  clearance: number;
  deformation: number;
  together: boolean;
  forces = true;
  labels = true;
  ghost: Ghost = "start";
  private readonly listeners: (() => void)[] = [];
  private last = 0;

  constructor(readonly run: Run) {
    const first = run.models[run.models.length - 1];
    if (!first) throw new Error("a run without models");
    this.model = first;
    this.clearance = run.data.scene.magnification;
    this.deformation = run.data.scene.magnification_of_deformation;
    this.together = this.clearance === this.deformation;
  }

  get end(): number {
    return Math.max(...this.run.models.map((model) => model.end));
  }

  /** Seconds that the whole program takes on the screen at speed 1. */
  get screenTime(): number {
    return 10;
  }

  listen(listener: () => void): void {
    this.listeners.push(listener);
  }

  change(
    change: Partial<
      Pick<
        Playhead,
        "time" | "speed" | "model" | "clearance" | "deformation" | "together" | "forces" | "labels" | "ghost"
      >
    >,
  ): void {
    Object.assign(this, change);
    this.time = Math.min(this.end, Math.max(0, this.time));
    if (this.together && change.clearance !== undefined) this.deformation = this.clearance;
    else if (this.together && change.deformation !== undefined) this.clearance = this.deformation;
    for (const listener of this.listeners) listener();
  }

  play(on = !this.playing): void {
    if (on === this.playing) return;
    this.playing = on;
    if (on) {
      if (this.time >= this.end) this.time = 0;
      this.last = performance.now();
      requestAnimationFrame((now) => this.advance(now));
    }
    this.change({});
  }

  private advance(now: number): void {
    if (!this.playing) return;
    // A hidden page gets no frames: no leap when it comes back.
    const passed = Math.min(0.25, Math.max(0, (now - this.last) / 1000));
    this.last = now;
    const time = this.time + (passed / this.screenTime) * this.speed * this.end;
    if (time >= this.end) this.playing = false;
    else requestAnimationFrame((next) => this.advance(next));
    this.change({ time });
  }

  /** Goes to the time nearest to now at which the temperature change has a value. */
  seekTemperature(value: number): void {
    const change = this.model.column("temperature_change_K"),
      times = this.model.time;
    if (!change) return;
    let best = this.time,
      distance = Infinity;
    for (let i = 0; i + 1 < times.length; i++) {
      const a = change[i] ?? 0,
        b = change[i + 1] ?? 0;
      if ((value - a) * (value - b) > 0) continue;
      const at = (times[i] ?? 0) + (a === b ? 0 : (value - a) / (b - a)) * ((times[i + 1] ?? 0) - (times[i] ?? 0));
      if (Math.abs(at - this.time) < distance) [best, distance] = [at, Math.abs(at - this.time)];
    }
    this.change({ time: best });
  }
}
