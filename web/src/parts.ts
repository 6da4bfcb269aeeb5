// SPDX-License-Identifier: GPL-3.0-or-later
// Solids of the replay: one class per type of part. Lengths are metres of the model, magnified where
// the replay says so; the scene scales them for the camera.
import * as THREE from "three";
import { decoded, PartData, SceneData } from "./payload";

export type Tone = "link" | "housing" | "pin" | "ground" | "spring";

/** What a part needs to know of a moment. */
export interface Pose {
  point(place: number): THREE.Vector3;
  value(what: number | string | undefined): number;
  /** Angle as drawn: its change is magnified like the deformation. */
  angle(what: number | string | undefined): number;
  clearance: number;
}

/** Dimensions that belong to the drawing, not to the model. */
export interface Measures {
  size: number;
  bar: number;
  depth: number;
  /** Length of the largest force. */
  arrow: number;
}

export interface Solid {
  readonly group: THREE.Group;
  /** Surfaces that take the colour of a contact, by contact name; "" for any. */
  readonly faces: Map<string, THREE.Mesh>;
  pose(pose: Pose): void;
}

export type Paint = (tone: Tone) => THREE.Material;

const SIDES = 64;
const X_AXIS = new THREE.Vector3(1, 0, 0);
const Z_AXIS = new THREE.Vector3(0, 0, 1);

/** Axis of a joint's part, z in the plane. */
export function axisOf(part: { axis?: [number, number, number] } | null | undefined): THREE.Vector3 {
  return part?.axis ? new THREE.Vector3(...part.axis) : Z_AXIS;
}

/** Turns a part about its axis. */
function orient(group: THREE.Group, part: PartData, angle: number): void {
  group.quaternion
    .setFromUnitVectors(Z_AXIS, axisOf(part))
    .multiply(new THREE.Quaternion().setFromAxisAngle(Z_AXIS, angle));
}

function mesh(geometry: THREE.BufferGeometry, material: THREE.Material): THREE.Mesh {
  const made = new THREE.Mesh(geometry, material);
  made.castShadow = made.receiveShadow = false;
  return made;
}

/** A disc or pin with its axis along z. */
function pin(radius: number, depth: number, material: THREE.Material): THREE.Mesh {
  return mesh(new THREE.CylinderGeometry(radius, radius, depth, SIDES).rotateX(Math.PI / 2), material);
}

/** Places something of unit length along x between two points. */
function stretch(object: THREE.Object3D, from: THREE.Vector3, to: THREE.Vector3): void {
  const along = to.clone().sub(from),
    length = along.length();
  object.position.copy(from);
  object.scale.x = Math.max(length, 1e-9);
  if (length > 0) object.quaternion.setFromUnitVectors(X_AXIS, along.divideScalar(length));
}

function simple(group: THREE.Group, pose: (pose: Pose) => void, faces = new Map<string, THREE.Mesh>()): Solid {
  return { group, pose, faces };
}

function link(part: PartData, scene: SceneData, measures: Measures, paint: Paint): Solid {
  const group = new THREE.Group();
  const width = Math.max(part.width_m ?? 0, measures.bar);
  const [first, second] = part.points as [number, number];
  const at = (place: number, type: string) =>
    scene.parts.find((other) => other.type === type && other.points[0] === place);
  const unit = new THREE.BoxGeometry(1, width, width).translate(0.5, 0, 0);
  const bar = mesh(unit, paint("link"));
  group.add(bar);
  // The link of a journal runs behind its bearing, so that the clearance stays in sight.
  const carried = [first, second].map((place) => at(place, "journal")).find(Boolean);
  const behind = carried !== undefined;
  const axis = axisOf(carried);
  const layer = behind ? -(measures.depth + width) / 2 - 0.1 * width : 0;
  const ends = [first, second].map((place) => {
    const bearing = at(place, "bearing");
    if (bearing) return { place, bearing };
    const eye = at(place, "block") ? null : pin(0.9 * width, 1.2 * width, paint("link"));
    if (eye) group.add(eye);
    return { place, eye };
  });
  return simple(group, (pose) => {
    const from = pose.point(first).clone(),
      to = pose.point(second).clone();
    const along = to.clone().sub(from).normalize();
    ends.forEach((end, i) => {
      const tip = i === 0 ? from : to;
      if (end.bearing && !behind)
        tip.addScaledVector(along, (i === 0 ? 1 : -1) * outerRadius(end.bearing, pose, measures, 0.5));
      end.eye?.position.copy(tip).addScaledVector(axis, layer);
    });
    from.addScaledVector(axis, layer);
    to.addScaledVector(axis, layer);
    stretch(bar, from, to);
  });
}

/** Radius of a bearing between its bore (share 0) and its outside (share 1), as drawn. */
function outerRadius(part: PartData, pose: Pose, measures: Measures, share: number): number {
  const inner = part.inner_m ?? part.radius_m ?? 0;
  return inner + pose.clearance * pose.value(part.clearance) + share * Math.max(0.4 * inner, 0.6 * measures.bar);
}

function bearing(part: PartData, measures: Measures, paint: Paint): Solid {
  const group = new THREE.Group();
  const ring = mesh(new THREE.BufferGeometry(), paint("housing"));
  group.add(ring);
  let drawn = -1;
  return simple(group, (pose) => {
    const bore = outerRadius(part, pose, measures, 0),
      outside = outerRadius(part, pose, measures, 1);
    if (Math.abs(bore - drawn) > 1e-6 * measures.size) {
      drawn = bore;
      const outline = new THREE.Shape().absarc(0, 0, outside, 0, 2 * Math.PI, false);
      outline.holes.push(new THREE.Path().absarc(0, 0, bore, 0, 2 * Math.PI, true));
      ring.geometry.dispose();
      ring.geometry = new THREE.ExtrudeGeometry(outline, {
        depth: measures.depth,
        bevelEnabled: false,
        curveSegments: SIDES,
      }).translate(0, 0, -measures.depth / 2);
    }
    group.position.copy(pose.point(part.points[0]!));
    orient(group, part, pose.angle(part.angle));
  });
}

function journal(part: PartData, measures: Measures, paint: Paint): Solid {
  const group = new THREE.Group();
  const radius = part.radius_m ?? 0,
    depth = 1.15 * measures.depth;
  const body = pin(radius, depth, paint("pin").clone());
  const mark = mesh(new THREE.BoxGeometry(0.8 * radius, 0.12 * radius, 0.02 * depth), paint("ground"));
  mark.position.set(0.5 * radius, 0, depth / 2);
  group.add(body, mark);
  return simple(
    group,
    (pose) => {
      group.position.copy(pose.point(part.points[0]!));
      orient(group, part, pose.angle(part.angle));
    },
    new Map([["", body]]),
  );
}

function block(part: PartData, measures: Measures, paint: Paint): Solid {
  const group = new THREE.Group();
  const body = mesh(
    new THREE.BoxGeometry(2 * (part.half_width_m ?? 0), 2 * (part.half_height_m ?? 0), measures.depth),
    paint("pin").clone(),
  );
  group.add(body);
  return simple(
    group,
    (pose) => {
      group.position.copy(pose.point(part.points[0]!));
      group.rotation.z = pose.angle(part.angle);
    },
    new Map([["", body]]),
  );
}

function slot(part: PartData, measures: Measures, paint: Paint): Solid {
  const group = new THREE.Group();
  const height = part.half_height_m ?? 0,
    thick = 0.16 * height,
    depth = 1.4 * measures.depth;
  const box = new THREE.BoxGeometry(1, 1, depth);
  const [floor, minus, plus] = ["floor", "stop_minus", "stop_plus"].map(() => mesh(box, paint("housing").clone()));
  group.add(floor!, minus!, plus!);
  return simple(
    group,
    (pose) => {
      const right = (part.inner_plus_m ?? 0) + pose.clearance * pose.value(part.clearance_plus);
      const left = (part.inner_minus_m ?? 0) + pose.clearance * pose.value(part.clearance_minus);
      // Below the stop on the bar's side the wall is open, as the bar comes through it.
      floor!.scale.set(left + right + 2 * thick, thick, 1);
      floor!.position.set((right - left) / 2, -height - thick / 2, 0);
      plus!.scale.set(thick, 1.5 * height, 1);
      plus!.position.set(right + thick / 2, -height / 4, 0);
      minus!.scale.set(thick, 0.8 * height, 1);
      minus!.position.set(-left - thick / 2, -0.6 * height, 0);
      group.position.copy(pose.point(part.points[0]!));
      group.rotation.z = pose.angle(part.angle);
    },
    new Map([
      ["floor", floor!],
      ["stop_minus", minus!],
      ["stop_plus", plus!],
    ]),
  );
}

function frame(part: PartData, measures: Measures, paint: Paint): Solid {
  const group = new THREE.Group();
  const width = 0.9 * measures.bar,
    behind = -1.6 * measures.depth;
  const bars = part.points
    .slice(1)
    .map(() => mesh(new THREE.BoxGeometry(1, width, 0.8 * width).translate(0.5, 0, 0), paint("ground")));
  const pins = part.points.map(() => pin(0.75 * measures.bar, 2.2 * measures.depth, paint("ground")));
  group.add(...bars, ...pins);
  return simple(group, (pose) => {
    const at = part.points.map((place) => pose.point(place).clone());
    pins.forEach((post, i) => post.position.copy(at[i]!).setZ(at[i]!.z - 0.55 * measures.depth));
    bars.forEach((bar, i) => stretch(bar, at[i]!.clone().setZ(behind), at[i + 1]!.clone().setZ(behind)));
  });
}

/** A wall: a frame whose points stand upright beside a link's end. */
function wall(part: PartData, measures: Measures, paint: Paint): Solid {
  const group = new THREE.Group();
  const plate = mesh(new THREE.BoxGeometry(1, 1, 2 * measures.depth), paint("ground"));
  group.add(plate);
  return simple(group, (pose) => {
    const [low, high] = [pose.point(part.points[0]!), pose.point(part.points[1]!)];
    plate.scale.set(1.2 * measures.bar, high.distanceTo(low), 1);
    plate.position.copy(low).add(high).multiplyScalar(0.5);
    plate.position.x -= 0.6 * measures.bar;
  });
}

function spring(part: PartData, measures: Measures, paint: Paint): Solid {
  const group = new THREE.Group();
  const radius = 0.9 * measures.bar,
    turns = 9,
    wire = 0.18 * measures.bar;
  const coil = (t: number) => {
    const inside = Math.min(1, Math.max(0, (t - 0.08) / 0.84)),
      reach = inside > 0 && inside < 1 ? radius : 0;
    const angle = 2 * Math.PI * turns * inside;
    return new THREE.Vector3(t, reach * Math.cos(angle), reach * Math.sin(angle));
  };
  const points = Array.from({ length: 40 * turns + 1 }, (_, i) => coil(i / (40 * turns)));
  let built = 0;
  const tube = mesh(new THREE.BufferGeometry(), paint("spring"));
  const spiral = mesh(
    new THREE.TubeGeometry(
      new THREE.CatmullRomCurve3(
        Array.from({ length: 120 }, (_, i) => {
          const angle = (6 * Math.PI * i) / 119,
            at = measures.bar * (1.2 + (1.6 * i) / 119);
          return new THREE.Vector3(at * Math.cos(angle), at * Math.sin(angle), 0);
        }),
      ),
      240,
      wire,
      6,
    ),
    paint("spring"),
  );
  group.add(tube, spiral);
  return simple(group, (pose) => {
    const [from, to] = [pose.point(part.points[0]!), pose.point(part.points[1]!)];
    const length = from.distanceTo(to);
    // A spring between two parts of one joint turns about it: drawn as a spiral in front.
    const turning = length < 0.12 * measures.size;
    tube.visible = !turning;
    spiral.visible = turning;
    if (turning) {
      spiral.position.copy(from).setZ(0.9 * measures.depth);
      return;
    }
    if (Math.abs(length - built) > 0.02 * measures.size) {
      // the wire keeps its thickness
      built = length;
      tube.geometry.dispose();
      const curve = new THREE.CatmullRomCurve3(points.map((point) => point.clone().setX(point.x * length)));
      tube.geometry = new THREE.TubeGeometry(curve, 40 * turns, wire, 6).scale(1 / length, 1, 1);
    }
    stretch(tube, from, to);
  });
}

function surface(part: PartData, paint: Paint): Solid {
  const group = new THREE.Group(),
    geometry = new THREE.BufferGeometry();
  const material = paint("housing").clone();
  material.side = THREE.DoubleSide;
  if (part.vertices !== undefined && part.triangles !== undefined) {
    geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(decoded(part.vertices, 0)), 3));
    geometry.setIndex(new THREE.BufferAttribute(Uint32Array.from(decoded(part.triangles, 0)), 1));
    geometry.computeVertexNormals();
  }
  group.add(mesh(geometry, material));
  return simple(group, (pose) => {
    group.position.copy(pose.point(part.points[0]!));
    group.rotation.z = pose.angle(part.angle);
  });
}

/** Makes the solid of a part; null for a type that the replay cannot draw. */
export function solid(part: PartData, scene: SceneData, measures: Measures, paint: Paint): Solid | null {
  switch (part.type) {
    case "link":
      return link(part, scene, measures, paint);
    case "bearing":
      return bearing(part, measures, paint);
    case "journal":
      return journal(part, measures, paint);
    case "block":
      return block(part, measures, paint);
    case "slot":
      return slot(part, measures, paint);
    case "spring":
      return spring(part, measures, paint);
    case "mesh":
      return surface(part, paint);
    case "frame": {
      const at = part.points.map((place) => scene.points[place]!.at);
      const upright = at.length === 2 && at[0]![0] === at[1]![0] && at[0]![1] !== at[1]![1];
      return upright ? wall(part, measures, paint) : frame(part, measures, paint);
    }
    default:
      return null;
  }
}
