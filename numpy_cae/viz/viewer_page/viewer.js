// Shows motions as moving skeletons. Every <script type="application/json" class="viewer-data"> of
// the page is replaced by a viewer of the motions in it. Drawing is three.js's; see viewer.py for
// the data.
import * as THREE from "three";
import { OrbitControls } from "three-orbit-controls";

const CHANGED = new THREE.Color("#d62728"); // a joint that was moved as far as any
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const HELP = "space: play or pause; ← →: one frame; Shift ← →: one second; Home, End; " +
  "f: follow; o: overlay; drag: orbit; wheel or pinch: zoom; hover: joint names";

// ---- data ----------------------------------------------------------------------------------

// Undo the differences between frames; `width` numbers a frame.
function cumulate(values, width) {
  for (let i = width; i < values.length; i++) values[i] += values[i - width];
  return values;
}

async function readMotion(packed) {
  const joints = packed.parents.length;
  const root = new Float32Array(await inflated(packed.root).arrayBuffer());
  const local = cumulate(new Int16Array(await inflated(packed.local).arrayBuffer()), 3 * joints);
  const moved = packed.moved ? new Uint8Array(await inflated(packed.moved).arrayBuffer()) : null;
  return { ...packed, joints, root, local, moved };
}

// Metres as text.
function inUnits(metres) {
  return metres < 0.995 ? `${(100 * metres).toPrecision(2)} cm` : `${metres.toFixed(1)} m`;
}

// World position of a joint in a frame, in metres.
function jointPosition(motion, frame, joint, into) {
  const at = 3 * (frame * motion.joints + joint);
  return into.set(
    motion.root[3 * frame] + motion.local[at] * motion.step,
    motion.root[3 * frame + 1] + motion.local[at + 1] * motion.step,
    motion.root[3 * frame + 2] + motion.local[at + 2] * motion.step,
  );
}

// ---- one figure ----------------------------------------------------------------------------

class Figure {
  constructor(motion) {
    this.motion = motion;
    this.group = new THREE.Group();
    const material = new THREE.MeshStandardMaterial({ roughness: 0.6 });
    const cylinder = new THREE.CylinderGeometry(1, 1, 1, 10).translate(0, 0.5, 0);
    this.balls = new THREE.InstancedMesh(new THREE.SphereGeometry(1, 14, 10), material, motion.joints);
    this.bones = new THREE.InstancedMesh(cylinder, material, motion.joints);
    for (const mesh of [this.balls, this.bones]) {
      mesh.frustumCulled = false;
      this.group.add(mesh);
    }
    this.colour = new THREE.Color(motion.colour);
    this.points = Array.from({ length: motion.joints }, () => new THREE.Vector3());
  }

  show(frame) {
    const { motion, points } = this;
    const matrix = new THREE.Matrix4(), turn = new THREE.Quaternion(), bone = new THREE.Vector3();
    const up = new THREE.Vector3(0, 1, 0), size = new THREE.Vector3(), shade = new THREE.Color();
    points.forEach((point, joint) => jointPosition(motion, frame, joint, point));
    points.forEach((point, joint) => {
      const moved = motion.moved ? motion.moved[frame * motion.joints + joint] / 255 : 0;
      shade.copy(this.colour).lerp(CHANGED, moved ? 0.25 + 0.75 * moved : 0);
      const radius = motion.radius * (1 + 0.7 * moved);
      this.balls.setMatrixAt(joint, matrix.compose(point, turn.identity(), size.setScalar(1.45 * radius)));
      this.balls.setColorAt(joint, shade);
      const parent = motion.parents[joint];
      bone.subVectors(parent < 0 ? point : points[parent], point);
      const length = bone.length();
      if (length > 0) turn.setFromUnitVectors(up, bone.divideScalar(length));
      this.bones.setMatrixAt(joint, matrix.compose(point, turn, size.set(radius, length, radius)));
      this.bones.setColorAt(joint, shade);
    });
    for (const mesh of [this.balls, this.bones]) {
      mesh.instanceMatrix.needsUpdate = true;
      mesh.instanceColor.needsUpdate = true;
      mesh.computeBoundingSphere();
    }
  }

  dispose() {
    for (const mesh of [this.balls, this.bones]) {
      mesh.geometry.dispose();
      mesh.material.dispose();
      mesh.dispose();
    }
  }
}

// ---- the stage -----------------------------------------------------------------------------

// Tiles of a few squares: software renderers drop a line that ends behind the camera.
function floor(size) {
  const tiles = new THREE.Group();
  for (let row = -5; row <= 5; row++) {
    for (let column = -5; column <= 5; column++) {
      const tile = new THREE.GridHelper(2 * size, 4, "#c4ccd4", "#c4ccd4");
      tile.position.set(2 * size * row, 0, 2 * size * column);
      tiles.add(tile);
    }
  }
  return tiles;
}

class Stage {
  constructor(canvas, motions, size) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color("#eef1f4");
    this.scene.add(new THREE.HemisphereLight("#ffffff", "#9aa4ae", 2.2));
    const sun = new THREE.DirectionalLight("#ffffff", 1.6);
    sun.position.set(2, 4, 3);
    this.scene.add(sun);
    this.size = size;
    this.grid = floor(size);
    this.scene.add(this.grid);
    this.figures = motions.map((motion) => new Figure(motion));
    this.figures.forEach((figure) => this.scene.add(figure.group));
    this.camera = new THREE.PerspectiveCamera(40, 1, size / 100, size * 200);
    this.controls = new OrbitControls(this.camera, canvas);
    this.ray = new THREE.Raycaster();
    this.target = new THREE.Vector3();
  }

  visible() {
    return this.figures.filter((figure) => figure.group.visible);
  }

  // Overlaid, motions are where they are in the world. Side by side they begin in a row at the
  // place of the first.
  arrange(overlaid) {
    const seen = this.visible();
    seen.forEach(({ group, motion }, place) => {
      group.position.set(0, 0, 0);
      if (overlaid) return;
      const first = seen[0].motion.root;
      group.position.x = first[0] - motion.root[0] + (place - (seen.length - 1) / 2) * this.size;
      group.position.z = first[2] - motion.root[2];
    });
    this.overlaid = overlaid;
  }

  middle(frame, into) {
    const seen = this.visible();
    const place = new THREE.Vector3();
    into.set(0, 0, 0);
    for (const { group, motion } of seen) {
      into.add(place.fromArray(motion.root, 3 * frame)).add(group.position);
    }
    return into.divideScalar(Math.max(seen.length, 1));
  }

  frontView(frame) {
    this.middle(frame, this.target);
    this.controls.target.copy(this.target);
    const across = this.overlaid ? 1 : this.visible().length;
    const narrow = Math.max(1, across / Math.max(this.camera.aspect, 0.3) / 2);
    const away = 3 * this.size * narrow;
    this.camera.position.copy(this.target).add(new THREE.Vector3(0.45 * away, 0.25 * away, away));
    this.controls.update();
  }

  show(frame, follow) {
    this.figures.forEach((figure) => figure.show(frame));
    const now = this.middle(frame, new THREE.Vector3());
    if (follow) {
      now.y = this.target.y;
      const step = now.clone().sub(this.target);
      this.camera.position.add(step);
      this.controls.target.add(step);
      this.target.copy(now);
    }
    // The grid is moved by whole squares, so that it never ends and never slides.
    const square = this.size / 2;
    this.grid.position.set(Math.round(now.x / square) * square, 0, Math.round(now.z / square) * square);
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.renderer.domElement.parentElement;
    if (width !== this.width || height !== this.height) {
      [this.width, this.height] = [width, height];
      this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / Math.max(height, 1);
      this.camera.updateProjectionMatrix();
    }
    this.renderer.render(this.scene, this.camera);
  }

  jointAt(x, y) {
    this.ray.setFromCamera(new THREE.Vector2(2 * x - 1, 1 - 2 * y), this.camera);
    const hits = this.visible().flatMap((figure) =>
      this.ray.intersectObject(figure.balls).map((hit) => ({ ...hit, figure })));
    hits.sort((one, other) => one.distance - other.distance);
    return hits.length ? { motion: hits[0].figure.motion, joint: hits[0].instanceId } : null;
  }

  dispose() {
    this.figures.forEach((figure) => figure.dispose());
    this.grid.children.forEach((tile) => tile.dispose());
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

// ---- the page ------------------------------------------------------------------------------

function element(parent, tag, properties = {}) {
  const made = Object.assign(document.createElement(tag), properties);
  parent.append(made);
  return made;
}

class Viewer {
  constructor(box, data, motions) {
    Object.assign(this, { box, motions, rate: data.rate, frames: data.frames, frame: 0, speed: 1 });
    this.playing = this.follow = true;
    this.overlaid = data.overlaid;
    this.build(data);
    this.stage = new Stage(this.canvas, motions, data.size);
    this.stage.arrange(this.overlaid);
    this.stage.draw();
    this.stage.frontView(0);
    this.observe();
    this.go(0);
    this.setPlaying(!matchMedia("(prefers-reduced-motion: reduce)").matches);
    this.tick = this.tick.bind(this);
    requestAnimationFrame(this.tick);
  }

  build(data) {
    const stage = element(this.box, "div", { className: "stage" });
    this.canvas = element(stage, "canvas");
    const legend = element(stage, "div", { className: "legend" });
    this.toggles = this.motions.map((motion) => {
      const label = element(legend, "label");
      const toggle = element(label, "input", { type: "checkbox", checked: true });
      element(label, "span", { className: "swatch" }).style.background = motion.colour;
      label.append(motion.label);
      return toggle;
    });
    if (data.furthest > 0) {
      const scale = element(stage, "div", { className: "scale" });
      scale.append("distance 0");
      const colour = this.motions.find((motion) => motion.moved).colour;
      element(scale, "i").style.background = `linear-gradient(to right, ${colour}, #d62728)`;
      scale.append(inUnits(data.furthest));
    }
    this.joint = element(stage, "div", { className: "joint", hidden: true });
    const bar = element(this.box, "div", { className: "bar" });
    this.button = element(bar, "button", { type: "button" });
    this.speeds = element(bar, "select", { title: "speed" });
    SPEEDS.forEach((speed) => element(this.speeds, "option", { value: speed, text: `${speed} ×` }));
    this.speeds.value = 1;
    this.time = element(bar, "span", { className: "time" });
    this.followBox = this.checkbox(bar, "follow", this.follow);
    this.overlayBox = this.checkbox(bar, "overlay", this.overlaid);
    this.overlayBox.parentElement.hidden = this.motions.length < 2;
    element(bar, "button", { type: "button", text: "?", textContent: "?", title: HELP })
      .addEventListener("click", () => alert(HELP.replaceAll("; ", "\n")));
    const line = element(this.box, "div", { className: "line" });
    this.slider = element(line, "input",
      { type: "range", min: 0, max: this.frames - 1, step: 1, value: 0, ariaLabel: "frame" });
    this.timeline = element(line, "canvas", { hidden: !data.tracks.length });
    this.tracks = data.tracks;
  }

  checkbox(parent, text, checked) {
    const label = element(parent, "label");
    const box = element(label, "input", { type: "checkbox", checked });
    label.append(text);
    return box;
  }

  observe() {
    this.button.addEventListener("click", () => this.setPlaying(!this.playing));
    this.speeds.addEventListener("change", () => { this.speed = Number(this.speeds.value); });
    this.slider.addEventListener("input", () => this.scrub(this.slider.valueAsNumber));
    this.followBox.addEventListener("change", () => { this.follow = this.followBox.checked; });
    this.overlayBox.addEventListener("change", () => this.arrange());
    this.toggles.forEach((toggle, place) => toggle.addEventListener("change", () => {
      this.stage.figures[place].group.visible = toggle.checked;
      this.arrange();
    }));
    this.canvas.addEventListener("pointermove", (event) => this.hover(event));
    this.canvas.addEventListener("pointerdown", (event) => this.hover(event));
    this.canvas.addEventListener("pointerleave", () => { this.joint.hidden = true; });
    this.timeline.addEventListener("pointerdown", (event) => {
      const share = event.offsetX / this.timeline.clientWidth;
      this.scrub(Math.round(share * (this.frames - 1)));
    });
    this.box.tabIndex = 0;
    this.box.addEventListener("keydown", (event) => this.key(event));
    this.resized = new ResizeObserver(() => { this.drawTimeline(); this.stage.draw(); });
    this.resized.observe(this.box);
  }

  key(event) {
    const seconds = Math.round(this.rate);
    const actions = {
      " ": () => this.setPlaying(!this.playing),
      ArrowLeft: () => this.scrub(this.frame - (event.shiftKey ? seconds : 1)),
      ArrowRight: () => this.scrub(this.frame + (event.shiftKey ? seconds : 1)),
      Home: () => this.scrub(0),
      End: () => this.scrub(this.frames - 1),
      f: () => this.followBox.click(),
      o: () => this.overlayBox.click(),
    };
    const onControl = event.target !== this.box && event.target !== this.slider;
    if (!(event.key in actions) || (onControl && event.key === " ")) return;
    event.preventDefault();
    actions[event.key]();
  }

  hover(event) {
    const area = this.canvas.getBoundingClientRect();
    const x = event.clientX - area.left, y = event.clientY - area.top;
    const hit = this.stage.jointAt(x / area.width, y / area.height);
    this.joint.hidden = !hit;
    if (!hit) return;
    const { motion, joint } = hit;
    const moved = motion.moved ? motion.moved[Math.floor(this.frame) * motion.joints + joint] : 0;
    const distance = `, ${inUnits(motion.furthest * moved / 255)} from ${this.motions[0].label}`;
    this.joint.textContent = motion.names[joint] + (moved ? distance : "");
    this.joint.style.left = `${x}px`;
    this.joint.style.top = `${y}px`;
  }

  arrange() {
    this.overlaid = this.overlayBox.checked;
    this.stage.arrange(this.overlaid);
    this.go(this.frame);
  }

  setPlaying(playing) {
    this.playing = playing;
    this.before = undefined;
    this.button.textContent = playing ? "❚❚" : "▶";
    this.button.title = playing ? "pause" : "play";
  }

  scrub(frame) {
    this.setPlaying(false);
    this.go(Math.min(Math.max(frame, 0), this.frames - 1));
  }

  go(frame) {
    this.frame = frame;
    const whole = Math.floor(frame);
    this.stage.show(whole, this.follow);
    this.slider.value = whole;
    this.time.textContent =
      `frame ${whole} of ${this.frames - 1}, ${(whole / this.rate).toFixed(2)} s`;
    this.drawTimeline();
  }

  tick(now) {
    if (!this.box.isConnected) return;
    if (this.playing) {
      const seconds = this.before === undefined ? 0 : Math.min((now - this.before) / 1000, 0.5);
      this.before = now;
      this.go((this.frame + seconds * this.rate * this.speed) % this.frames);
    }
    this.stage.draw();
    this.request = requestAnimationFrame(this.tick);
  }

  // One row a track, below its label: how much of the body is damaged or moved in each frame.
  drawTimeline() {
    if (!this.tracks.length) return;
    const row = 32, bar = 16, width = this.timeline.clientWidth, height = row * this.tracks.length;
    const sharp = Math.min(window.devicePixelRatio, 2);
    if (this.timeline.width !== Math.round(width * sharp)) {
      this.timeline.width = Math.round(width * sharp);
      this.timeline.height = height * sharp;
      this.timeline.style.height = `${height}px`;
    }
    const pen = this.timeline.getContext("2d");
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "11px system-ui, sans-serif";
    this.tracks.forEach((track, place) => {
      pen.fillStyle = "#eef1f4";
      pen.fillRect(0, (place + 1) * row - bar - 1, width, bar);
      pen.fillStyle = track.colour;
      track.values.forEach((value, frame) => {
        const tall = value * bar;
        const left = frame / this.frames * width;
        if (tall > 0) pen.fillRect(left, (place + 1) * row - 1 - tall, width / this.frames + 0.5, tall);
      });
      pen.fillStyle = "#1d2733";
      pen.fillText(track.label, 0, place * row + 11);
    });
    pen.fillRect(Math.floor(this.frame) / Math.max(this.frames - 1, 1) * (width - 1), 0, 1.5, height);
  }

  dispose() {
    cancelAnimationFrame(this.request);
    this.resized.disconnect();
    this.stage.dispose();
    this.box.replaceChildren();
  }
}

// A browser allows few WebGL contexts, so a viewer exists only while it is on the screen.
function mount(script) {
  const data = JSON.parse(script.textContent);
  const box = document.createElement("div");
  box.className = script.classList.contains("whole") ? "viewer whole" : "viewer";
  script.replaceWith(box);
  const motions = Promise.all(data.motions.map(readMotion));
  new IntersectionObserver(async ([entry]) => {
    const ready = await motions;
    if (entry.isIntersecting && !box.viewer) {
      try {
        box.viewer = new Viewer(box, data, ready);
      } catch (error) {
        const text = `The motion cannot be drawn: ${error.message} This viewer needs WebGL.`;
        box.replaceChildren();
        element(box, "p", { className: "failure", textContent: text });
        box.viewer = { dispose() {} };
      }
    } else if (!entry.isIntersecting && box.viewer) {
      box.viewer.dispose();
      delete box.viewer;
    }
  }, { rootMargin: "200px" }).observe(box);
}

document.querySelectorAll("script.viewer-data").forEach(mount);
window.motionViewers = () => [...document.querySelectorAll(".viewer")].map((box) => box.viewer);
