// One body: a ball for each joint, a cylinder for each bone, a shadow, its path and its planted feet.
import * as THREE from "three";
import { jointPosition } from "motion-data";
import { Trail } from "motion-trail";

const CHANGED = new THREE.Color("#d62728"); // a joint at the upper end of the scale of distances or beyond
const NEAR = new THREE.Color("#8d97a1"); // a joint below the lower end
const WHITE = new THREE.Color("#fff"), BLACK = new THREE.Color("#000");
const UP = new THREE.Vector3(0, 1, 0);
// Points of the floor below the points of a body, for a light above and beside it.
const FLAT = new THREE.Matrix4().set(1, -0.2, 0, 0, 0, 0, 0, 0.004, 0, -0.12, 1, 0, 0, 0, 0, 1);
const GHOST = { opacity: 0.5, wider: 1.9 };
// The light of the sky and of a sun, white so that a colour keeps its hue, computed at the corners of
// triangles: at every pixel it takes most of the time of a software renderer.
const LIT = `
  varying vec3 shade;
  void main() {
    vec3 way = normalize(mat3(modelMatrix) * mat3(instanceMatrix) * normal);
    vec3 sky = mix(vec3(0.26), vec3(0.7), 0.5 * way.y + 0.5);
    vec3 light = sky + 0.5 * max(dot(way, vec3(0.37, 0.74, 0.56)), 0.0);
    shade = pow(min(instanceColor * light, 1.0), vec3(1.0 / 2.2));
    gl_Position = projectionMatrix * modelViewMatrix * instanceMatrix * vec4(position, 1.0);
  }`;
const SHADED = "uniform float opacity; varying vec3 shade; void main() { gl_FragColor = vec4(shade, opacity); }";

// The colour of a joint at a level of the scale of distances: 0 is below the scale, 1 to 255 go from one
// end to the other.
export function levelColour(level, own, into = new THREE.Color()) {
  return level ? into.copy(own).lerp(CHANGED, (level - 1) / 254) : into.copy(NEAR);
}

export class Figure {
  constructor(motion) {
    this.motion = motion;
    this.group = new THREE.Group();
    this.body = new THREE.Group();
    this.ground = new THREE.Group();
    this.offset = new THREE.Vector3();
    this.material = new THREE.ShaderMaterial({ vertexShader: LIT, fragmentShader: SHADED, uniforms: { opacity: { value: 1 } } });
    this.dark = new THREE.MeshBasicMaterial();
    this.balls = this.mesh(new THREE.SphereGeometry(1, 12, 8), motion.joints);
    this.bones = this.mesh(new THREE.CylinderGeometry(1, 1, 1, 9, 1, true).translate(0, 0.5, 0), motion.joints);
    this.shadow = new THREE.Group();
    for (const mesh of [this.balls, this.bones]) {
      const flat = new THREE.InstancedMesh(mesh.geometry, this.dark, motion.joints);
      flat.instanceMatrix = mesh.instanceMatrix;
      flat.frustumCulled = false;
      this.shadow.add(flat);
    }
    this.shadow.matrixAutoUpdate = false;
    this.shadow.matrix.copy(FLAT);
    this.feet = this.mesh(new THREE.RingGeometry(2.2, 3.4, 24).rotateX(-Math.PI / 2), motion.planted.size,
      new THREE.MeshBasicMaterial({ side: THREE.DoubleSide }));
    this.path = this.pathLine();
    this.trail = new Trail(motion);
    this.body.add(this.balls, this.bones, this.trail.group);
    this.ground.add(this.shadow, this.feet);
    this.group.add(this.body, this.ground, this.path);
    this.points = Array.from({ length: motion.joints }, () => new THREE.Vector3());
    this.setColours(false, new THREE.Color("#aab"));
  }

  mesh(geometry, count, material = this.material) {
    const mesh = new THREE.InstancedMesh(geometry, material, count);
    mesh.frustumCulled = false;
    return mesh;
  }

  // Where the first joint was, on the floor. Short pieces: software renderers drop a line that ends
  // behind the camera.
  pathLine() {
    const { positions, joints, frames } = this.motion, ends = [];
    const stride = Math.max(1, Math.ceil(frames / 2000));
    const at = (frame) => [positions[3 * frame * joints], 0.006, positions[3 * frame * joints + 2]];
    for (let frame = stride; frame < frames; frame += stride) ends.push(...at(frame - stride), ...at(frame));
    const line = new THREE.BufferGeometry();
    line.setAttribute("position", new THREE.Float32BufferAttribute(ends, 3));
    const lines = new THREE.LineSegments(line, new THREE.LineBasicMaterial());
    lines.frustumCulled = false;
    return lines;
  }

  // On a dark page a body is a little lighter, unless its colours are those of the scale of distances.
  setColours(onDark, shadow) {
    const own = this.own = new THREE.Color(this.motion.colour).lerp(WHITE, onDark && !this.motion.moved ? 0.2 : 0);
    this.dark.color.copy(shadow);
    this.path.material.color.copy(own);
    this.trail.setColour(own);
    this.feet.material.color.copy(own).lerp(onDark ? WHITE : BLACK, 0.3);
  }

  // A ghost is wide and translucent, and only its far side is drawn, so that a body in the same place
  // is seen within it as if it were not there.
  setGhost(ghost) {
    this.wider = ghost ? GHOST.wider : 1;
    this.shadow.visible = !ghost && !this.light;
    const side = ghost ? THREE.BackSide : THREE.FrontSide;
    Object.assign(this.material, { transparent: ghost, depthWrite: !ghost, side });
    this.material.uniforms.opacity.value = ghost ? GHOST.opacity : 1;
    this.material.needsUpdate = true;
    this.balls.renderOrder = this.bones.renderOrder = ghost ? 1 : 0;
  }

  show(frame) {
    const { motion, points } = this;
    const matrix = new THREE.Matrix4(), turn = new THREE.Quaternion(), bone = new THREE.Vector3();
    const size = new THREE.Vector3(), shade = new THREE.Color(), place = new THREE.Vector3();
    points.forEach((point, joint) => jointPosition(motion, frame, joint, point));
    points.forEach((point, joint) => {
      const level = motion.moved ? motion.moved[joint * motion.frames + frame] : 0, side = motion.sides[joint];
      if (motion.moved) levelColour(level, this.own, shade);
      else shade.copy(this.own).lerp(side > 0 ? WHITE : BLACK, side ? 0.3 : 0); // left is lighter
      const radius = motion.radius * (1 + 0.7 * level / 255) * this.wider;
      const parent = motion.parents[joint];
      bone.subVectors(point, parent < 0 ? point : points[parent]);
      const length = bone.length();
      if (length > 0) turn.setFromUnitVectors(UP, bone.divideScalar(length));
      else turn.identity();
      size.set(radius, length, radius);
      this.bones.setMatrixAt(joint, matrix.compose(parent < 0 ? point : points[parent], turn, size));
      place.copy(point);
      size.setScalar(1.45 * radius);
      if (joint === motion.head) {
        place.addScaledVector(bone, 2.5 * motion.radius);
        size.set(4, 5.3, 4).multiplyScalar(motion.radius * (this.wider + 3) / 4);
      }
      this.balls.setMatrixAt(joint, matrix.compose(place, turn, size));
      for (const mesh of [this.balls, this.bones]) mesh.setColorAt(joint, shade);
    });
    [...motion.planted].forEach(([joint, frames], number) => {
      place.copy(points[joint]).setY(0.008);
      size.setScalar(frames[frame] ? motion.radius : 0);
      this.feet.setMatrixAt(number, matrix.compose(place, turn.identity(), size));
    });
    this.trail.show(frame);
    this.feet.instanceMatrix.needsUpdate = true;
    for (const mesh of [this.balls, this.bones]) mesh.instanceMatrix.needsUpdate = mesh.instanceColor.needsUpdate = true;
  }

  // Draw the body this far from its place; its path stays where it is.
  moveBy(offset) {
    this.offset.copy(offset);
    this.body.position.copy(offset);
    this.ground.position.set(offset.x, 0, offset.z);
  }

  // Fewer triangles and no shadow.
  lighten() {
    this.light = true;
    for (const [mesh, coarse] of [[this.balls, new THREE.OctahedronGeometry(1, 1)],
      [this.bones, new THREE.CylinderGeometry(1, 1, 1, 5, 1, true).translate(0, 0.5, 0)]]) {
      mesh.geometry.dispose();
      mesh.geometry = coarse;
    }
  }

  dispose() {
    this.group.traverse((mesh) => {
      mesh.geometry?.dispose();
      mesh.material?.dispose();
      mesh.dispose?.();
    });
  }
}
