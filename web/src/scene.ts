// SPDX-License-Identifier: GPL-3.0-or-later
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Arrow, FORCE_KINDS } from "./arrows";
import { element, number } from "./elements";
import { Cursor, Model, Run, SceneData } from "./payload";
import { Measures, Pose, Solid, solid, Tone } from "./parts";
import { Playhead } from "./playhead";
import { colour } from "./theme";

export const VIEWS = ["oblique", "front", "top", "joint"] as const;
export type View = (typeof VIEWS)[number];
const DIRECTIONS: Record<View, [number, number, number]> = {
  oblique: [-0.42, 0.42, 1],
  front: [0, 0, 1],
  top: [0, 1, 0.001],
  joint: [0.12, 0.16, 1],
};
const TONES: Record<Tone, string> = {
  link: "part-link",
  housing: "part-housing",
  pin: "part-pin",
  ground: "part-ground",
  spring: "part-spring",
};
const FIELD_OF_VIEW = 24; // degrees
const MARGIN = 1.12;
// Thickness of links that are thinner, and length of the largest force: shares of the scene's size,
// but of the shortest link no more than leaves it recognizable.
const BAR = 0.014;
const BAR_OF_LINK = 0.1;
const ARROW = 0.2;
const ARROW_OF_LINK = 0.8;
const LOOKS = 40; // moments that the camera is placed for
const LABEL_STEPS = [0, -1, 1]; // heights by which a label may be off its place
const MOST_LABELS = 8; // contacts beyond which labels would hide the parts
// A contact whose parts would be lost in a large scene gets a bead in the colour of its state: its radius as a
// share of the scene's size, of the shortest link at most.
const BEAD = 0.006;
const BEAD_OF_LINK = 0.3;

/** A moment of a model as it is drawn: places magnified. */
class Moment implements Pose {
  readonly clearance: number;
  private readonly points = new Map<number, THREE.Vector3>();

  constructor(
    private readonly scene: SceneData,
    private readonly model: Model,
    private readonly at: Cursor,
    clearance: number,
    private readonly deformation: number,
  ) {
    this.clearance = clearance;
  }

  value(what: number | string | undefined): number {
    return this.model.value(what, this.at);
  }

  angle(what: number | string | undefined): number {
    const start = this.model.value(what, { index: 0, fraction: 0 });
    return start + this.deformation * (this.value(what) - start);
  }

  /** A part's place: the start's plus the magnified way from there; for a part that rests on or in
   *  another, that of the other plus the magnified relative place. */
  point(place: number): THREE.Vector3 {
    const known = this.points.get(place);
    if (known) return known;
    const data = this.scene.points[place]!;
    const drawn =
      data.of === undefined
        ? new THREE.Vector3(...(data.at.map((what) => this.angle(what)) as [number, number, number]))
        : this.point(data.of)
            .clone()
            .add(
              new THREE.Vector3(
                ...(data.at.map((what) => this.clearance * this.value(what)) as [number, number, number]),
              ),
            );
    this.points.set(place, drawn);
    return drawn;
  }
}

/** A set of solids; the ghost is a second, translucent one. */
class Assembly {
  readonly group = new THREE.Group();
  readonly solids: (Solid | null)[];
  private readonly materials = new Map<Tone, THREE.MeshStandardMaterial>();
  private readonly all: THREE.MeshStandardMaterial[] = [];

  constructor(
    scene: SceneData,
    measures: Measures,
    private readonly ghost: boolean,
  ) {
    this.solids = scene.parts.map((part) => {
      const still = part.type === "frame" || part.type === "mesh" || part.type === "spring";
      return ghost && still ? null : solid(part, scene, measures, (tone) => this.material(tone));
    });
    for (const made of this.solids) if (made) this.group.add(made.group);
  }

  private material(tone: Tone): THREE.MeshStandardMaterial {
    const found = this.materials.get(tone);
    if (found) return found;
    const made = new THREE.MeshStandardMaterial({
      roughness: 0.6,
      metalness: 0,
      transparent: this.ghost,
      opacity: this.ghost ? 0.22 : 1,
      depthWrite: !this.ghost,
      polygonOffset: this.ghost,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 4,
    });
    made.userData["tone"] = tone;
    this.materials.set(tone, made);
    this.all.push(made);
    return made;
  }

  /** Gives every surface its colour of the theme; faces of contacts are painted afterwards. */
  tint(): void {
    this.group.traverse((object) => {
      const material = (object as THREE.Mesh).material as THREE.MeshStandardMaterial | undefined;
      const tone = material?.userData["tone"] as Tone | undefined;
      if (material && tone) material.color.set(this.ghost ? colour("ink") : colour(TONES[tone]));
    });
  }

  pose(pose: Pose): void {
    for (const made of this.solids) made?.pose(pose);
  }
}

/** The picture: draws when something has changed, not all the time. */
export class SceneView {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly stage = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private readonly measures: Measures;
  private readonly bodies: Assembly;
  private readonly ghost: Assembly;
  private readonly arrows: Arrow[];
  private readonly beads = new Map<number, THREE.Mesh>();
  private readonly paints = new Map<string, THREE.MeshStandardMaterial>();
  private readonly labels: HTMLElement[];
  private readonly world = new THREE.Group();
  private readonly centre: THREE.Vector3;
  private readonly scale: number;
  private readonly resize: ResizeObserver;
  private view: View = "oblique";
  private followed: THREE.Vector3 | null = null;
  /** Parts that carry contacts, and which of them the view of a joint shows. */
  private readonly joints: number[];
  private shown = 0;
  private pending = false;
  private moved = false;

  /** For browsers that have WebGL only. */
  constructor(
    private readonly holder: HTMLElement,
    private readonly run: Run,
    private readonly head: Playhead,
  ) {
    const scene = run.data.scene;
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    const low = new THREE.Vector3(...(scene.low as [number, number, number]));
    const high = new THREE.Vector3(...(scene.high as [number, number, number]));
    const size = Math.max(high.x - low.x, high.y - low.y, high.z - low.z) || 1;
    this.scale = 10 / size;
    this.centre = low.clone().add(high).multiplyScalar(0.5);
    const radii = scene.parts.flatMap((part) => part.radius_m ?? part.half_height_m ?? []);
    const bar = Math.min(BAR * size, BAR_OF_LINK * scene.shortest_link_m);
    this.measures = {
      size,
      bar,
      depth: Math.max(2 * bar, 0.8 * Math.max(0, ...radii)),
      arrow: Math.min(ARROW * size, ARROW_OF_LINK * scene.shortest_link_m),
    };
    this.bodies = new Assembly(scene, this.measures, false);
    this.ghost = new Assembly(scene, this.measures, true);
    this.ghost.group.position.z = -0.02 * this.measures.depth; // behind, where surfaces coincide
    this.arrows = scene.forces.map(
      (force) => new Arrow(force, scene, this.measures, this.paint(FORCE_KINDS[force.kind] ?? "force-external")),
    );
    this.world.scale.setScalar(this.scale);
    this.world.position.copy(this.centre).multiplyScalar(-this.scale);
    const bead = Math.min(BEAD * size, BEAD_OF_LINK * scene.shortest_link_m);
    for (const { on } of scene.contacts) {
      const { radius_m: radius, half_width_m: half } = scene.parts[on]!;
      if ((radius ?? half ?? bead) < bead)
        this.beads.set(on, new THREE.Mesh(new THREE.SphereGeometry(bead, 20, 14), new THREE.MeshStandardMaterial()));
    }
    this.world.add(
      this.bodies.group,
      this.ghost.group,
      ...this.arrows.map((arrow) => arrow.group),
      ...this.beads.values(),
    );
    const key = new THREE.DirectionalLight(0xffffff, 2.2),
      fill = new THREE.DirectionalLight(0xffffff, 0.7);
    key.position.set(-4, 9, 10);
    fill.position.set(8, -2, 6);
    this.stage.add(this.world, new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.6), key, fill);
    const canvas = this.renderer.domElement;
    canvas.setAttribute("aria-hidden", "true");
    holder.append(canvas);
    this.joints = [...new Set(scene.contacts.map((contact) => contact.on))];
    this.labels = this.joints.map((part) => element("div", { class: "tag", "data-part": part }));
    holder.append(...this.labels);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableZoom = false; // the wheel scrolls the page; see the buttons and keys
    canvas.addEventListener(
      "wheel",
      (event) => {
        if (!event.ctrlKey) return;
        event.preventDefault();
        this.zoom(event.deltaY < 0 ? 1.15 : 1 / 1.15);
      },
      { passive: false },
    );
    canvas.style.touchAction = "pan-y"; // a finger moving up or down scrolls the page
    this.controls.addEventListener("change", () => this.request());
    this.controls.addEventListener("start", () => {
      this.moved = true;
    });
    this.resize = new ResizeObserver(() => this.fit());
    this.resize.observe(holder);
    this.theme();
    this.fit();
    this.look("oblique");
    head.listen(() => this.request());
  }

  private paint(name: string): THREE.MeshStandardMaterial {
    const found = this.paints.get(name) ?? new THREE.MeshStandardMaterial({ roughness: 0.7 });
    this.paints.set(name, found);
    return found;
  }

  theme(): void {
    this.bodies.tint();
    this.ghost.tint();
    for (const [name, material] of this.paints) material.color.set(colour(name));
    this.request();
  }

  private fit(): void {
    const width = this.holder.clientWidth,
      height = this.holder.clientHeight;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (!this.moved) this.look(this.view);
    this.request();
  }

  /** A view as the reader asks for it: the joint's, asked again, goes on to the next joint. */
  choose(view: View): void {
    if (view === "joint" && this.view === "joint" && !this.moved) this.shown = (this.shown + 1) % this.joints.length;
    this.look(view);
  }

  /** Moves the camera to a preset from which everything, or one joint, is in sight. */
  look(view: View): void {
    this.view = view;
    this.moved = false;
    const direction = new THREE.Vector3(...DIRECTIONS[view]).normalize();
    const joint = view === "joint" ? this.joint() : null;
    let half: THREE.Vector3, target: THREE.Vector3;
    if (joint) {
      const reach = this.jointReach() * this.scale;
      half = new THREE.Vector3(reach, reach, reach * 0.4);
      target = joint;
    } else {
      const reach = this.reach();
      half = reach.getSize(new THREE.Vector3()).multiplyScalar(this.scale / 2);
      target = reach.getCenter(new THREE.Vector3()).sub(this.centre).multiplyScalar(this.scale);
    }
    const right = new THREE.Vector3(0, 1, 0).cross(direction).normalize();
    if (right.lengthSq() < 0.5) right.set(1, 0, 0);
    const up = direction.clone().cross(right);
    const tan = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    let distance = 0;
    for (let corner = 0; corner < 8; corner++) {
      const at = half
        .clone()
        .multiply(new THREE.Vector3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
      const need = Math.max(Math.abs(at.dot(up)) / tan, Math.abs(at.dot(right)) / (tan * this.camera.aspect));
      distance = Math.max(distance, need * MARGIN + at.dot(direction));
    }
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction, distance);
    this.camera.near = distance / 100;
    this.camera.far = distance * 10;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.followed = joint;
    this.request();
  }

  /** Space that the parts take up during the run, as magnified now. */
  private reach(): THREE.Box3 {
    const { scene } = this.run.data,
      box = new THREE.Box3();
    const low = new THREE.Vector3(...(scene.low as [number, number, number])),
      high = new THREE.Vector3(...(scene.high as [number, number, number]));
    box.set(low, high);
    for (let look = 0; look <= LOOKS; look++) {
      const now = this.moment(this.head.model, (look / LOOKS) * this.head.end);
      for (const part of scene.parts) {
        const wide = part.half_width_m ?? part.inner_m ?? part.radius_m ?? 0,
          tall = part.half_height_m ?? wide;
        const play = part.clearance !== undefined ? this.head.clearance * now.value(part.clearance) : 0;
        for (const place of part.points) {
          const at = now.point(place),
            around = new THREE.Vector3(1.4 * wide + play, 1.4 * tall + play, this.measures.depth);
          box.expandByPoint(at.clone().sub(around)).expandByPoint(at.clone().add(around));
        }
      }
    }
    return box;
  }

  zoom(factor: number): void {
    this.moved = true;
    this.camera.position.sub(this.controls.target).divideScalar(factor).add(this.controls.target);
    this.controls.update();
    this.request();
  }

  /** Where the part of the joint in view is drawn, in the camera's world. */
  private joint(): THREE.Vector3 | null {
    const place = this.run.data.scene.parts[this.joints[this.shown] ?? -1]?.points[0];
    if (place === undefined) return null;
    return this.moment().point(place).clone().sub(this.centre).multiplyScalar(this.scale);
  }

  private jointReach(): number {
    const { scene } = this.run.data;
    const part = scene.parts[this.joints[this.shown] ?? 0];
    const radius = part?.radius_m ?? Math.max(part?.half_width_m ?? 0, part?.half_height_m ?? 0);
    return 1.7 * radius + 1.3 * this.head.clearance * scene.clearance_m;
  }

  private moment(model = this.head.model, time = this.head.time): Moment {
    return new Moment(this.run.data.scene, model, model.cursor(time), this.head.clearance, this.head.deformation);
  }

  private request(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.draw();
    });
  }

  private draw(): void {
    const now = this.moment();
    this.bodies.pose(now);
    for (const [part, bead] of this.beads) {
      bead.visible = this.followed === null; // seen from near the joint itself tells it
      bead.position.copy(now.point(this.run.data.scene.parts[part]!.points[0]!));
    }
    this.colourContacts();
    const other = this.run.models.find((model) => model !== this.head.model);
    this.ghost.group.visible = this.head.ghost !== "none" && (this.head.ghost === "start" || other !== undefined);
    if (this.ghost.group.visible) {
      this.ghost.pose(this.head.ghost === "start" ? this.moment(this.head.model, 0) : this.moment(other));
    }
    for (const arrow of this.arrows) {
      arrow.pose(now);
      arrow.group.visible &&= this.head.forces;
    }
    const joint = this.followed ? this.joint() : null;
    if (joint && this.followed) {
      const way = joint.clone().sub(this.followed);
      this.controls.target.add(way);
      this.camera.position.add(way);
      this.followed = joint;
    }
    this.camera.lookAt(this.controls.target);
    this.camera.updateMatrixWorld();
    this.tag(now);
    this.renderer.render(this.stage, this.camera);
    const pixels =
      this.holder.clientHeight /
      (2 * Math.tan((FIELD_OF_VIEW * Math.PI) / 360) * this.camera.position.distanceTo(this.controls.target));
    this.holder.dataset["gapPixels"] = (
      pixels *
      this.scale *
      this.head.clearance *
      this.run.data.scene.clearance_m
    ).toFixed(2);
    this.holder.dataset["frames"] = String(Number(this.holder.dataset["frames"] ?? 0) + 1);
  }

  /** The part that carries a contact takes the colour of its state, the face that it touches too. */
  private colourContacts(): void {
    const { scene } = this.run.data,
      at = this.head.model.cursor(this.head.time);
    const worst = new Map<number, number>();
    for (const contact of scene.contacts) {
      const state = this.head.model.nearest(contact.state, at);
      worst.set(contact.on, Math.max(worst.get(contact.on) ?? 0, state));
      const face = this.bodies.solids[contact.from]?.faces.get(contact.name);
      if (face)
        (face.material as THREE.MeshStandardMaterial).color.set(
          state === 0 ? colour("part-housing") : scene.states[state]!.colour,
        );
    }
    for (const [part, state] of worst) {
      const face = this.bodies.solids[part]?.faces.get("");
      for (const surface of [face, this.beads.get(part)])
        if (surface) (surface.material as THREE.MeshStandardMaterial).color.set(scene.states[state]!.colour);
    }
  }

  private tag(now: Moment): void {
    const { scene } = this.run.data,
      at = this.head.model.cursor(this.head.time);
    const taken: { left: number; top: number; half: number }[] = [];
    for (const label of this.labels) {
      const part = Number(label.dataset["part"]);
      const seen = scene.contacts.length <= MOST_LABELS || (this.followed && part === this.joints[this.shown]);
      label.hidden = !this.head.labels || !seen;
      if (label.hidden) continue;
      const contacts = scene.contacts.filter((contact) => contact.on === part);
      const texts = contacts.flatMap((contact) => {
        const state = this.head.model.nearest(contact.state, at);
        if (state === 0 && contacts.length > 1) return [];
        const gap = 1e6 * Math.abs(this.head.model.value(contact.gap, at));
        return [`${contact.label}: ${scene.states[state]!.label}${state === 0 ? ` ${number(gap, 3)} µm` : ""}`];
      });
      label.textContent = texts.join(" · ");
      const place = now.point(scene.parts[part]!.points[0]!).clone();
      const { half_height_m: height, radius_m: radius } = scene.parts[part]!;
      place.y += (height ?? 1.6 * (radius ?? 0) + 2 * now.clearance * scene.clearance_m) + this.measures.bar;
      place.sub(this.centre).multiplyScalar(this.scale).project(this.camera);
      const width = this.holder.clientWidth,
        half = label.offsetWidth / 2 + 6;
      const left = Math.min(width - half, Math.max(half, ((place.x + 1) / 2) * width));
      const wanted = Math.max(label.offsetHeight + 6, ((1 - place.y) / 2) * this.holder.clientHeight);
      // Above its joint, or a little off, where no other label is; else not at all.
      const top = LABEL_STEPS.map((step) => wanted + step * (label.offsetHeight + 2)).find(
        (y) =>
          y >= label.offsetHeight &&
          !taken.some(
            (other) => Math.abs(other.left - left) < other.half + half && Math.abs(other.top - y) < label.offsetHeight,
          ),
      );
      if (top === undefined) {
        label.hidden = true;
        continue;
      }
      taken.push({ left, top, half });
      label.style.transform = `translate(${left}px, ${top}px) translate(-50%, -100%)`;
    }
  }

  dispose(): void {
    this.resize.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.holder.replaceChildren();
  }
}
