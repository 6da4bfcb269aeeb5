// SPDX-License-Identifier: GPL-3.0-or-later
import * as THREE from "three";
import { ForceData, SceneData } from "./payload";
import { axisOf, Measures, Pose } from "./parts";

/** Colours of the style by kind of force. */
export const FORCE_KINDS: Record<string, string> = {
  normal: "force-normal",
  tangential: "force-tangential",
  axial: "force-axial",
  external: "force-external",
};
const SHORTEST = 0.1; // of the longest arrow
const NONE = 1e-6; // of the largest force: not drawn

/** An arrow whose length grows with the square root of its force: impacts and holding forces differ
 *  by orders of magnitude. */
export class Arrow {
  readonly group = new THREE.Group();
  private readonly shaft: THREE.Mesh;
  private readonly head: THREE.Mesh;

  constructor(
    readonly force: ForceData,
    private readonly scene: SceneData,
    private readonly measures: Measures,
    material: THREE.Material,
  ) {
    const thick = 0.22 * measures.bar;
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(thick, thick, 1, 16).translate(0, 0.5, 0), material);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(2.6 * thick, 6 * thick, 20).translate(0, 3 * thick, 0), material);
    this.group.add(this.shaft, this.head);
  }

  pose(pose: Pose): void {
    const [x, y, z] = this.force.vector.map((component) => pose.value(component)) as [number, number?, number?];
    const { from, point } = this.force;
    const vector =
      from === undefined
        ? new THREE.Vector3(x, y, z)
        : pose.point(point).clone().sub(pose.point(from)).normalize().multiplyScalar(x);
    const size = vector.length(),
      largest = this.scene.largest_force_N;
    this.group.visible = size > NONE * largest;
    if (!this.group.visible) return;
    const headLength = 6 * 0.22 * this.measures.bar;
    const length = Math.max(SHORTEST, Math.sqrt(size / largest)) * this.measures.arrow;
    this.shaft.scale.y = length;
    this.head.position.y = length;
    const arm = this.force.arm.map((component) => pose.value(component)) as [number, number, number];
    const along = vector.divideScalar(size);
    // The point of the arrow touches where the force acts, in front of the parts.
    this.group.position
      .copy(pose.point(this.force.point))
      .add(new THREE.Vector3(...arm))
      .addScaledVector(along, -(length + headLength));
    this.group.position.addScaledVector(axisOf(this.force), 0.8 * this.measures.depth);
    this.group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along);
  }
}
