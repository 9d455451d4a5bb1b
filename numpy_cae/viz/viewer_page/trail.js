// The chosen joint five frames before and after, as onion skins: its bone and a ball in each frame.
import * as THREE from "three";
import { jointPosition } from "motion-data";

const AROUND = 5; // frames before and after

export class Trail {
  constructor(motion) {
    Object.assign(this, { motion, joint: -1, group: new THREE.Group() });
    this.material = new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.55 });
    this.balls = new THREE.InstancedMesh(new THREE.SphereGeometry(1, 8, 6), this.material, 2 * AROUND + 1);
    this.line = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.55 });
    const ends = new THREE.BufferGeometry();
    // In each frame the bone, and the way to the next frame.
    ends.setAttribute("position", new THREE.BufferAttribute(new Float32Array(12 * (2 * AROUND + 1)), 3));
    this.bones = new THREE.LineSegments(ends, this.line);
    for (const mesh of [this.balls, this.bones]) mesh.frustumCulled = false;
    this.group.add(this.balls, this.bones);
    this.group.visible = false;
  }

  // Show the joint of that name; one that the motion lacks hides the trail.
  setJoint(name) {
    this.joint = this.motion.names.indexOf(name);
    this.group.visible = this.joint >= 0;
  }

  setColour(colour) {
    this.material.color.copy(colour);
    this.line.color.copy(colour);
  }

  show(frame) {
    if (this.joint < 0) return;
    const { motion, joint } = this, parent = motion.parents[joint] < 0 ? joint : motion.parents[joint];
    const place = new THREE.Vector3(), matrix = new THREE.Matrix4(), ends = this.bones.geometry.attributes.position;
    const at = (wanted) => Math.min(Math.max(wanted, 0), motion.frames - 1);
    for (let skin = 0; skin <= 2 * AROUND; skin++) {
      const now = at(frame + skin - AROUND), next = at(Math.min(frame + skin - AROUND + 1, frame + AROUND));
      jointPosition(motion, now, joint, place);
      const size = 0.9 * motion.radius * (now === frame ? 0 : 1);
      this.balls.setMatrixAt(skin, matrix.makeScale(size, size, size).setPosition(place));
      [[now, parent], [now, joint], [now, joint], [next, joint]].forEach(([of, end], number) => {
        jointPosition(motion, of, end, place);
        ends.setXYZ(4 * skin + number, place.x, place.y, place.z);
      });
    }
    this.balls.instanceMatrix.needsUpdate = ends.needsUpdate = true;
  }
}
