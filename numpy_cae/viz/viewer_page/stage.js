// The scene. Overlaid, all bodies are in one picture, where they are in the world; bodies that are
// compared have their first joints in one place, that of the last body. Side by side each has a picture
// of its own, from the same camera, so that equal bodies look equal.
import * as THREE from "three";
import { OrbitControls } from "three-orbit-controls";
import { Figure } from "motion-figure";
import { facing } from "motion-data";

const SQUARE = 1; // metres
const VIEW = 28; // degrees from the lowest to the highest point of the picture

// Squares of a metre, of lines that are one square long: software renderers drop a line that ends
// behind the camera.
function metreGrid(squares) {
  const ends = [];
  for (let line = -squares; line <= squares; line++) {
    for (let piece = -squares; piece < squares; piece++) {
      const [a, b, c] = [line, piece, piece + 1].map((value) => value * SQUARE);
      ends.push(a, 0, b, a, 0, c, b, 0, a, c, 0, a);
    }
  }
  const lines = new THREE.BufferGeometry();
  lines.setAttribute("position", new THREE.Float32BufferAttribute(ends, 3));
  return new THREE.LineSegments(lines, new THREE.LineBasicMaterial());
}

const square = (value) => value - Math.round(value / SQUARE) * SQUARE;

// Whether WebGL is computed by the processor.
export function isSoftware() {
  const context = document.createElement("canvas").getContext("webgl");
  const names = context?.getExtension("WEBGL_debug_renderer_info");
  const name = names ? context.getParameter(names.UNMASKED_RENDERER_WEBGL) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

export class Stage {
  // `light` is for slow computers: rough edges, fewer triangles and no shadow.
  constructor(canvas, motions, light = false) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !light });
    this.renderer.setScissorTest(true);
    this.sharp = Math.min(window.devicePixelRatio, light ? 1 : 2);
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color();
    this.scene.fog = new THREE.Fog(0);
    this.grid = metreGrid(12);
    this.scene.add(this.grid);
    this.figures = motions.map((motion) => new Figure(motion));
    if (light) this.figures.forEach((figure) => figure.lighten());
    this.figures.forEach((figure) => this.scene.add(figure.group));
    this.camera = new THREE.PerspectiveCamera(VIEW, 1, 0.05, 500);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => { this.changed = true; });
    this.aligned = motions.some(({ moved }) => moved); // compared motions have their first joints in one place
    this.shown = new Set(this.figures);
    this.frame = 0;
  }

  visible() {
    return this.figures.filter((figure) => this.shown.has(figure));
  }

  // The colours of the page: `style` is that of the element around the canvas.
  setColours(style) {
    this.scene.background.setStyle(style.backgroundColor);
    this.grid.material.color.setStyle(style.borderTopColor);
    this.scene.fog.color.copy(this.scene.background);
    const onDark = this.scene.background.getHSL({}).l < 0.4;
    this.figures.forEach((figure) => figure.setColours(onDark, new THREE.Color().setStyle(style.borderBottomColor)));
    this.show(this.frame);
  }

  // Show the joint of that name in the frames around, in all bodies that have it; "" hides it.
  setTrail(name) {
    this.trailed = name;
    this.figures.forEach((figure) => figure.trail.setJoint(name));
    this.show(this.frame);
  }

  arrange(overlaid, follow) {
    Object.assign(this, { overlaid, follow });
    const seen = this.visible();
    seen.forEach((figure, place) => figure.setGhost(overlaid && place === 0 && seen.length > 1));
    this.show(this.frame);
  }

  // Seen from a direction, "front", "side", "top" or in between, the bodies fill the picture.
  view(name = "") {
    const seen = this.visible();
    if (!seen.length) return;
    const sizes = seen.map((figure) => figure.motion.size);
    const tall = Math.max(...sizes.map((size) => size.tall));
    let wide = Math.max(...sizes.map((size) => size.radius + (this.follow ? 0 : size.path)));
    if (this.overlaid && this.follow && !this.aligned) wide += this.spread(seen);
    this.resize();
    this.extent = name === "top" ? { wide, high: wide, deep: tall } : { wide, high: 0.6 * tall, deep: 0.5 * Math.min(wide, tall) };
    const [x, z] = facing(seen[0].motion, this.frame);
    const angle = { front: 0, side: Math.PI / 2, top: 0 }[name] ?? 0.55;
    const to = new THREE.Vector3(x * Math.cos(angle) + z * Math.sin(angle), 0, z * Math.cos(angle) - x * Math.sin(angle));
    to.y = { top: 40, front: 0.08, side: 0.08 }[name] ?? 0.22;
    this.controls.target.set(0, name === "top" ? 0 : 0.53 * tall, 0);
    this.camera.position.copy(this.controls.target).addScaledVector(to.normalize(), this.away());
    this.controls.update();
    this.changed = true;
  }

  // The distance from which the bodies fill a picture; what is further away is in fog.
  away() {
    const { wide, high, deep } = this.extent, half = Math.tan(VIEW / 2 * Math.PI / 180);
    const away = Math.max(high, wide / (this.panes()[0]?.aspect ?? 1)) / half * 1.06 + deep;
    Object.assign(this.camera, { near: away / 100, far: away * 20 });
    Object.assign(this.scene.fog, { near: 1.2 * away, far: Math.max(3.5 * away, 12) });
    return away;
  }

  // How far the first joints of bodies are from their middle in this frame.
  spread(seen) {
    const middle = this.anchor(seen);
    return Math.max(...seen.map(({ points: [root] }) => Math.hypot(root.x - middle[0], root.z - middle[1])));
  }

  // The place on the floor that is in the middle of a picture.
  anchor(figures) {
    if (this.aligned && this.overlaid) figures = figures.slice(-1);
    const places = figures.map(({ motion, points: [root] }) => this.follow ? [root.x, root.z] : motion.size.middle);
    return [0, 1].map((axis) => places.reduce((sum, place) => sum + place[axis], 0) / Math.max(places.length, 1));
  }

  show(frame) {
    this.frame = frame;
    this.figures.forEach((figure) => figure.show(frame));
    const { points: [target] } = this.visible().at(-1) ?? this.figures[0];
    this.figures.forEach((figure) => {
      const [root] = figure.points;
      figure.moveBy(this.aligned && this.overlaid ? target.clone().sub(root) : new THREE.Vector3());
    });
    this.changed = true;
  }

  // One picture for all bodies, or one for each, from left to right, in rows if they were too narrow.
  panes() {
    const seen = this.visible(), groups = this.overlaid ? [seen] : seen.map((figure) => [figure]);
    let rows = 1, columns = groups.length;
    while (columns > 1 && this.width / columns < 0.2 * this.height / rows) columns = Math.ceil(groups.length / ++rows);
    const width = this.width / Math.max(columns, 1), height = this.height / rows;
    return groups.map((figures, place) => ({
      figures, width, height, left: place % columns * width, top: Math.floor(place / columns) * height,
      aspect: width / Math.max(height, 1), anchor: this.anchor(figures),
    }));
  }

  // In a picture of another shape the bodies are as large as they fit, seen from the same direction.
  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (width === this.width && height === this.height && this.renderer.getPixelRatio() === this.sharp) return;
    const before = this.extent && this.away(), { target } = this.controls;
    Object.assign(this, { width, height, changed: true });
    if (before) this.camera.position.sub(target).multiplyScalar(this.away() / before).add(target);
    this.renderer.setPixelRatio(this.sharp);
    this.renderer.setSize(width, height, false);
  }

  // The camera and the places of the bodies as in one of the pictures.
  enter({ aspect, anchor: [x, z], figures }) {
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
    this.grid.position.set(square(-x), 0, square(-z));
    this.figures.forEach((figure) => {
      figure.group.visible = figures.includes(figure);
      figure.group.position.set(-x, 0, -z);
    });
  }

  draw() {
    this.controls.update();
    this.resize();
    if (!this.changed) return;
    this.changed = false;
    for (const pane of this.panes()) {
      this.enter(pane);
      const place = [pane.left, this.height - pane.top - pane.height, pane.width, pane.height];
      this.renderer.setViewport(...place);
      this.renderer.setScissor(...place);
      this.renderer.render(this.scene, this.camera);
    }
  }

  // Where a joint is on the canvas, in pixels from its upper left corner.
  onScreen(pane, figure, joint) {
    const [x, z] = pane.anchor;
    const seen = figure.points[joint].clone().add(figure.offset).add({ x: -x, y: 0, z: -z });
    this.camera.aspect = pane.aspect;
    this.camera.updateProjectionMatrix();
    seen.project(this.camera);
    return [pane.left + (seen.x + 1) / 2 * pane.width, pane.top + (1 - seen.y) / 2 * pane.height];
  }

  // The joint next to a point of the canvas, at most 14 pixels away; else undefined.
  jointAt(x, y) {
    const near = this.panes().flatMap((pane) => pane.figures.flatMap((figure) => figure.points.map((_, joint) => {
      const [a, b] = this.onScreen(pane, figure, joint);
      return { motion: figure.motion, joint, away: Math.hypot(a - x, b - y) };
    })));
    return near.filter((hit) => hit.away < 14).sort((one, other) => one.away - other.away)[0];
  }

  // Pixels that are drawn for one of the page.
  setSharpness(sharp) {
    Object.assign(this, { sharp, changed: true });
  }

  dispose() {
    this.figures.forEach((figure) => figure.dispose());
    this.grid.geometry.dispose();
    this.grid.material.dispose();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}
