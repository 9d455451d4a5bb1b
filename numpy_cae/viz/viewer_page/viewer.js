// Shows motions as moving skeletons. Every <script type="application/json" class="viewer-data"> of
// the page is replaced by a viewer of the motions in it. Drawing is three.js's; see viewer.py for
// the data.
import { Stage, isSoftware } from "motion-stage";
import { CURVES, Timeline } from "motion-timeline";
import { Film, canFilm, download } from "motion-film";
import { FindingsPanel } from "motion-findings";
import { centimetres, distance, readMotions } from "motion-data";
import { levelColour } from "motion-figure";
import { Color } from "three";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const VIEWS = ["front", "side", "top"];
const SLOW = 20, FAST = 40; // pictures a second: below, drawing is made lighter; above, heavier again
const HELP = {
  "space": "play or pause", "← →": "one frame", "Shift ← →": "one second", "Home, End": "first and last frame",
  "a, b": "start and end of the loop here", "c": "loop all frames", "1, 2, 3": "from the front, side, top",
  "f": "follow the body", "o": "overlay", "?": "this list", "drag": "turn the camera", "wheel, pinch": "zoom",
};
const NOTES = "Frames are those of the file, counted from 0. A square of the floor is 1 m; x and z are its directions. " +
  "The left side of a body is lighter, the right side darker; a body in the colours of a distance has no such sides, and is " +
  "thicker where it is further away. Rings mark feet that stand. The line on the floor is the path of the hips. A click on a " +
  "joint shows its curve, and where it is five frames before and after.";

function element(parent, tag, properties = {}) {
  const made = Object.assign(document.createElement(tag), properties);
  parent.append(made);
  return made;
}

class Viewer {
  constructor(box, data, motions) {
    Object.assign(this, { box, data, motions, rate: data.rate, frames: data.frames, frame: 0, speed: 1 });
    this.whole = box.classList.contains("whole");
    this.build(data);
    this.lighter = Number(isSoftware());
    this.tooHeavy = [0, 0];
    this.stage = new Stage(this.canvas, motions, this.lighter > 0);
    this.observe();
    this.recolour();
    this.arrange();
    this.setPlaying(!matchMedia("(prefers-reduced-motion: reduce)").matches);
    this.start();
    this.tick = this.tick.bind(this);
    requestAnimationFrame(this.tick);
  }

  build(data) {
    const labels = this.motions.map((motion) => motion.label).join(", ");
    Object.assign(this.box, { tabIndex: -1, role: "group", ariaLabel: `Animation: ${labels}` });
    const bar = element(this.box, "div", { className: "bar" }); // first: Play is the first stop of the keyboard
    const upper = element(this.box, "div", { className: "upper" });
    const picture = element(upper, "div", { className: "picture" });
    this.buildLegend(element(picture, "div", { className: "legend" }), data);
    this.area = element(picture, "div", { className: "stage" });
    this.canvas = element(this.area, "canvas", { role: "img" });
    this.canvas.ariaLabel = `Moving stick figures: ${labels}; ${this.frames} frames at ${Math.round(this.rate)} a second` +
      (data.findings.length ? "; what was found to be damaged is listed beside the picture" : "");
    this.names = element(this.area, "div", { ariaHidden: "true" });
    this.joint = element(this.area, "div", { className: "joint", hidden: true });
    this.buildHelp(this.area);
    if (data.findings.length) {
      const panel = element(upper, "div", { className: "findings", role: "region", ariaLabel: "Findings", tabIndex: 0 });
      this.panel = new FindingsPanel(panel, element, { ...data, motions: this.motions }, (row) => this.showFinding(row));
    }
    this.buildBar(bar, data);
    const line = element(this.box, "div", { className: "line" });
    this.slider = element(line, "input",
      { type: "range", min: 0, max: this.frames - 1, step: 1, value: 0, ariaLabel: "frame" });
    this.lines = element(line, "canvas", { ariaHidden: "true" });
    this.timeline = new Timeline(this.lines, this.motions, data.findings, this.frames, data.rows);
  }

  buildLegend(legend, data) {
    this.toggles = this.motions.map((motion) => {
      const toggle = this.checkbox(legend, motion.label, true);
      const swatch = element(toggle.parentElement, "span", { className: "swatch" });
      swatch.style.background = motion.moved ? `linear-gradient(#8d97a1 50%, ${motion.colour} 50%)` : motion.colour;
      toggle.after(swatch);
      return toggle;
    });
    const compared = this.motions.find((motion) => motion.moved);
    if (!compared) return;
    const scale = element(legend, "span", { className: "scale" });
    const [least, most] = data.scale.map((metres) => 100 * metres);
    const shade = (level) => levelColour(level, new Color(compared.colour)).getStyle();
    scale.append(`distance from ${this.motions[0].label}: `);
    element(scale, "i", { className: "below" }).style.background = shade(0);
    scale.append(`below ${least} cm`);
    const levels = Array.from({ length: 9 }, (_, part) => shade(1 + Math.round(part / 8 * 254)));
    const ticks = element(scale, "span", { className: "ticks" });
    element(ticks, "i").style.background = `linear-gradient(to right, ${levels.join(", ")})`;
    for (const textContent of [`${least} cm`, Math.round(Math.sqrt(least * most)), `${most} or more`]) element(ticks, "span", { textContent });
  }

  buildHelp(area) {
    this.help = element(area, "div", { className: "help", hidden: true, role: "region", ariaLabel: "Help", tabIndex: -1 });
    const list = element(this.help, "dl");
    Object.entries(HELP).forEach(([key, meaning]) => {
      element(list, "dt", { textContent: key });
      element(list, "dd", { textContent: meaning });
    });
    element(this.help, "p", { textContent: NOTES });
  }

  buildBar(bar, data) {
    this.playButton = this.button(bar, "", "play", () => this.setPlaying(!this.playing));
    this.speeds = this.select(bar, "speed", SPEEDS.map((speed) => [speed, `${speed} ×`]), () => { this.speed = Number(this.speeds.value); });
    this.speeds.value = 1;
    const label = element(bar, "label", { textContent: "frame " });
    this.number = element(label, "input", { type: "number", min: 0, max: this.frames - 1, value: 0, ariaLabel: "frame number" });
    this.time = element(bar, "span", { className: "time" });
    this.button(bar, "loop start", "loop start: repeat from this frame (a)", () => this.mark(0));
    this.button(bar, "loop end", "loop end: repeat to this frame (b)", () => this.mark(1));
    this.unmark = this.button(bar, "loop all", "loop all: repeat all frames (c)", () => this.mark());
    VIEWS.forEach((name) => this.button(bar, name, `seen from the ${name}`, () => this.stage.view(name)));
    this.followBox = this.checkbox(bar, "follow", true);
    this.overlayBox = this.checkbox(bar, "overlay", data.overlaid);
    this.overlayBox.parentElement.hidden = this.motions.length < 2;
    const names = this.motions[0].names.map((name) => [name, name.replaceAll("_", " ")]);
    this.jointSelect = this.select(bar, "curve of", [["", "no joint"], ...names], () => this.setCurve());
    this.quantity = this.select(bar, "curve shows", Object.keys(CURVES).map((name) => [name, name]), () => this.setCurve());
    this.quantity.parentElement.hidden = true;
    this.filmButton = this.button(bar, "film", "film: save what is repeated as a WebM file", () => this.toggleFilm());
    this.filmButton.hidden = !canFilm();
    this.helpButton = this.button(bar, "?", "?: help", () => this.toggleHelp());
    this.helpButton.ariaExpanded = "false";
    this.mark();
  }

  button(parent, text, label, action) {
    const button = element(parent, "button", { type: "button", textContent: text, title: label, ariaLabel: label });
    button.addEventListener("click", action);
    return button;
  }

  select(parent, text, options, action) {
    const label = element(parent, "label", { textContent: `${text} ` });
    const select = element(label, "select", { ariaLabel: text });
    options.forEach(([value, shown]) => element(select, "option", { value, text: shown }));
    select.addEventListener("change", action);
    return select;
  }

  checkbox(parent, text, checked) {
    const label = element(parent, "label");
    const box = element(label, "input", { type: "checkbox", checked });
    label.append(text);
    return box;
  }

  observe() {
    this.slider.addEventListener("input", () => this.scrub(this.slider.valueAsNumber));
    this.number.addEventListener("change", () => this.scrub(Math.round(this.number.valueAsNumber || 0)));
    this.followBox.addEventListener("change", () => this.arrange());
    this.overlayBox.addEventListener("change", () => this.arrange());
    this.toggles.forEach((toggle) => toggle.addEventListener("change", () => this.arrange()));
    this.area.addEventListener("pointermove", (event) => this.hover(event));
    this.area.addEventListener("click", (event) => this.hover(event, true));
    this.area.addEventListener("pointerleave", () => { this.joint.hidden = true; });
    for (const kind of ["pointerdown", "pointermove"]) {
      this.lines.addEventListener(kind, (event) => { if (event.buttons) this.scrub(this.timeline.frameAt(event.offsetX)); });
    }
    this.ended = new AbortController();
    const { signal } = this.ended;
    (this.whole ? document : this.box).addEventListener("keydown", (event) => this.key(event), { signal });
    if (this.whole) window.addEventListener("hashchange", () => this.readAddress(), { signal });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.recolour(), { signal });
    for (const kind of ["beforeprint", "afterprint"]) window.addEventListener(kind, () => this.recolourForPaper(kind), { signal });
    this.themed = new MutationObserver(() => this.recolour());
    this.themed.observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme", "style"] });
    this.resized = new ResizeObserver(() => { this.stage.draw(); this.nameBodies(); this.drawTimeline(); });
    this.resized.observe(this.area);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.matches("select, textarea, input:not([type=range], [type=checkbox])")) return;
    if (event.key === " " && event.target.matches("button, input, a, summary")) return;
    const seconds = Math.round(this.rate);
    const actions = {
      " ": () => this.setPlaying(!this.playing),
      ArrowLeft: () => this.scrub(this.wholeFrame() - (event.shiftKey ? seconds : 1)),
      ArrowRight: () => this.scrub(this.wholeFrame() + (event.shiftKey ? seconds : 1)),
      Home: () => this.scrub(0),
      End: () => this.scrub(this.frames - 1),
      a: () => this.mark(0), b: () => this.mark(1), c: () => this.mark(),
      1: () => this.stage.view("front"), 2: () => this.stage.view("side"), 3: () => this.stage.view("top"),
      f: () => this.followBox.click(), o: () => this.overlayBox.click(),
      "?": () => this.toggleHelp(), Escape: () => this.toggleHelp(true),
    };
    if (!(event.key in actions)) return;
    event.preventDefault();
    actions[event.key]();
  }

  // Record what is repeated, once from its start, or end the film that is being recorded.
  toggleFilm() {
    if (this.film) {
      this.film.stop();
      return;
    }
    this.go(this.loop?.[0] ?? 0);
    this.setPlaying(true);
    const name = document.title.replace(/[^\p{L}\p{N}]+/gu, "_") || "motion";
    this.film = new Film(this.canvas, (file) => {
      this.film = null;
      this.filmButton.textContent = "film";
      download(file, `${name}.webm`);
    });
    this.filmButton.textContent = "end film";
  }

  wholeFrame() {
    return Math.floor(this.frame);
  }

  toggleHelp(hide = !this.help.hidden) {
    this.help.hidden = hide;
    this.helpButton.ariaExpanded = String(!hide);
  }

  showFinding({ finding: { frames: [first, last] }, mover, moved: { axis } }) {
    this.go(first);
    this.jointSelect.value = mover;
    this.quantity.value = ["x", "height", "z"][axis];
    this.timeline.chosen = [first, last];
    this.setCurve();
    this.mark(0, Math.max(first - Math.round(this.rate / 3), 0));
    this.mark(1, Math.min(last + Math.round(this.rate / 3), this.frames - 1));
  }

  // A page starts at the frame of its address or where it was left, else at the first finding or change.
  start() {
    if (this.readAddress()) return;
    if (this.panel && this.box.leftAt === undefined) this.panel.choose(this.panel.rows[0]);
    else this.go(this.box.leftAt ?? this.timeline.firstChange());
  }

  setCurve() {
    this.quantity.parentElement.hidden = !this.jointSelect.value;
    this.timeline.setCurve(this.jointSelect.value, this.quantity.value);
    this.stage.setTrail(this.jointSelect.value);
    this.drawTimeline();
  }

  // Set the beginning (0) or the end (1) of what is repeated; without an argument repeat everything.
  mark(end, frame = this.wholeFrame()) {
    if (end === undefined) this.loop = null;
    else {
      this.loop ??= [0, this.frames - 1];
      this.loop[end] = frame;
      if (this.loop[0] >= this.loop[1]) this.loop = end ? [0, frame] : [frame, this.frames - 1];
    }
    this.unmark.hidden = !this.loop;
    if (this.stage) this.drawTimeline();
  }

  hover(event, chosen) {
    if (event.target !== this.canvas) return;
    const area = this.canvas.getBoundingClientRect();
    const x = event.clientX - area.left, y = event.clientY - area.top;
    const hit = this.stage.jointAt(x, y);
    this.joint.hidden = !hit;
    if (!hit) return;
    const { motion, joint } = hit;
    const apart = () => `, ${centimetres(100 * distance(motion, this.motions[0], this.wholeFrame(), joint))} from ${this.motions[0].label}`;
    this.joint.textContent = motion.names[joint] + (motion.moved ? apart() : "");
    Object.assign(this.joint.style, { left: `${Math.min(x, area.width - 110)}px`, top: `${y}px` });
    if (!chosen || !this.motions[0].names.includes(motion.names[joint])) return;
    this.jointSelect.value = motion.names[joint];
    this.setCurve();
  }

  arrange() {
    this.stage.shown = new Set(this.stage.figures.filter((_, place) => this.toggles[place].checked));
    this.stage.arrange(this.overlayBox.checked, this.followBox.checked);
    this.stage.view();
    this.nameBodies();
  }

  // The label of each body above it, if each has a picture of its own.
  nameBodies() {
    this.names.replaceChildren();
    const panes = this.stage.panes();
    if (panes.length < 2) return;
    panes.forEach(({ figures: [{ motion }], left, top, width, height }) => {
      const name = element(this.names, "span", { className: "name", textContent: motion.label });
      const percent = (part, of) => `${100 * part / of}%`, bottom = percent(this.stage.height - top - height, this.stage.height);
      Object.assign(name.style, { left: percent(left, this.stage.width), bottom, width: percent(width, this.stage.width) });
    });
  }

  // Paper is light, also where the page is dark. A browser prints what WebGL showed last, so that a copy
  // of what it draws now takes its place.
  recolourForPaper(kind) {
    const printed = document.documentElement.classList.toggle("printed", kind === "beforeprint");
    this.canvas.hidden = printed;
    this.panel?.unfold(printed);
    this.recolour();
    this.stage.setSharpness(printed ? 2 : this.sharpness());
    this.stage.draw();
    this.paper?.remove();
    if (!printed) return;
    this.paper = element(this.area, "canvas", { width: this.canvas.width, height: this.canvas.height });
    this.paper.getContext("2d").drawImage(this.canvas, 0, 0);
  }

  recolour() {
    this.stage.setColours(getComputedStyle(this.area));
    this.timeline.width = 0;
    this.drawTimeline();
  }

  setPlaying(playing) {
    this.playing = playing;
    this.before = undefined;
    this.playButton.textContent = playing ? "❚❚" : "▶";
    this.playButton.title = this.playButton.ariaLabel = playing ? "pause" : "play";
    this.stage.setSharpness(this.sharpness());
  }

  scrub(frame) {
    this.setPlaying(false);
    this.go(Math.min(Math.max(frame, 0), this.frames - 1));
    if (!this.whole || !location.protocol.match(/^(http|file)/)) return;
    history.replaceState(null, "", `#frame=${this.frame}`);
  }

  // #frame=58 in the address of a page that is a viewer.
  readAddress() {
    const found = this.whole && location.hash.match(/frame=(\d+)/);
    if (found) this.scrub(Number(found[1]));
    return Boolean(found);
  }

  go(frame) {
    this.frame = frame;
    const whole = this.wholeFrame();
    this.stage.show(whole);
    this.slider.value = whole;
    if (document.activeElement !== this.number) this.number.value = whole;
    this.time.textContent = `of 0 to ${this.frames - 1}, ${(whole / this.rate).toFixed(2)} s`;
    this.drawTimeline();
  }

  tick(now) {
    if (!this.box.isConnected) return;
    if (this.playing) {
      const seconds = this.before === undefined ? 0 : Math.min((now - this.before) / 1000, 0.5);
      this.before = now;
      const [first, last] = this.loop ?? [0, this.frames - 1];
      const next = this.frame + seconds * this.rate * this.speed;
      const before = this.wholeFrame();
      if (next >= last + 1) this.film?.stop();
      this.frame = next >= last + 1 || next < first ? first : next;
      if (this.wholeFrame() !== before) this.go(this.frame);
      this.measure(seconds);
    }
    if (this.film) this.stage.changed = true;
    this.stage.draw();
    this.request = requestAnimationFrame(this.tick);
  }

  // Pictures a second over two seconds; where they are few, drawing is made lighter, at most twice, and
  // heavier again where they are many. What was too heavy twice is not tried again.
  measure(seconds) {
    this.times = seconds ? [...this.times ?? [], seconds] : [];
    const passed = this.times.reduce((sum, each) => sum + each, 0);
    if (passed < 2 || this.film) return;
    this.fps = this.times.length / passed;
    this.times = [];
    if (this.fps < SLOW && this.lighter < 2) this.tooHeavy[this.lighter] += 1;
    const heavier = this.fps > FAST && this.tooHeavy[this.lighter - 1] < 2;
    const next = Math.min(this.lighter + (this.fps < SLOW) - heavier, 2);
    if (next === this.lighter) return;
    const before = this.lighter;
    this.lighter = next;
    if (!next || !before) this.redraw(next > 0);
    this.stage.setSharpness(this.sharpness());
  }

  // Pixels that are drawn for one of the page: few on a slow computer, while it plays.
  sharpness() {
    const most = Math.min(window.devicePixelRatio, 2);
    return this.playing ? [most, Math.min(most, 1), 0.6][this.lighter] : most;
  }

  // A canvas keeps its way of drawing, so that another way needs another canvas.
  redraw(light) {
    const { camera, controls } = this.stage;
    const canvas = this.canvas.cloneNode();
    this.stage.dispose();
    this.canvas.replaceWith(canvas);
    this.canvas = canvas;
    this.stage = new Stage(canvas, this.motions, light);
    this.stage.setTrail(this.jointSelect.value);
    this.recolour();
    this.arrange();
    this.stage.camera.position.copy(camera.position);
    this.stage.controls.target.copy(controls.target);
    this.stage.show(this.wholeFrame());
  }

  drawTimeline() {
    this.timeline.draw(this.frame, this.loop, getComputedStyle(this.area));
  }

  dispose() {
    this.box.leftAt = this.frame;
    cancelAnimationFrame(this.request);
    this.film?.stop();
    this.ended.abort();
    this.themed.disconnect();
    this.resized.disconnect();
    this.stage.dispose();
    this.box.replaceChildren();
  }
}

// A viewer in a box. A browser allows few WebGL contexts, so a viewer exists only while it is on the
// screen.
export function mount(box, data, motions) {
  const title = data.motions.map((motion) => motion.label).join(", ");
  const say = (text) => box.replaceChildren(Object.assign(document.createElement("p"), { className: "failure", textContent: text }));
  say(`Animation: ${title}`);
  new IntersectionObserver(async ([entry]) => {
    const ready = await motions;
    if (entry.isIntersecting && !box.viewer) {
      box.replaceChildren();
      try {
        box.viewer = new Viewer(box, data, ready);
      } catch (error) {
        say(`The motion cannot be drawn: ${error.message} This viewer needs WebGL.`);
        box.viewer = { dispose() {} };
      }
    } else if (!entry.isIntersecting && box.viewer) {
      box.viewer.dispose();
      delete box.viewer;
      say(`Animation: ${title}`);
    }
  }, { rootMargin: "200px" }).observe(box);
}

// A page in a frame, such as the output of a notebook's cell, is as dark as the page around it.
function followPage() {
  if (window.parent === window) return;
  try {
    const outer = parent.document, own = document.documentElement;
    const copy = () => {
      const { theme } = outer.documentElement.dataset, { jpThemeLight } = outer.body.dataset;
      const dark = theme ? theme === "dark" : jpThemeLight && jpThemeLight === "false";
      if (theme || jpThemeLight) own.style.colorScheme = dark ? "dark" : "light";
    };
    copy();
    const watch = new MutationObserver(copy);
    for (const node of [outer.documentElement, outer.body]) watch.observe(node, { attributes: true });
  } catch (error) {
    console.debug(error); // a page from elsewhere: the reader's own setting is used
  }
}

followPage();
document.querySelectorAll("script.viewer-data").forEach((script) => {
  const data = JSON.parse(script.textContent);
  const box = document.createElement("div");
  box.className = script.classList.contains("whole") ? "viewer whole" : "viewer";
  script.replaceWith(box);
  mount(box, data, readMotions(data));
});
window.motionViewers = () => [...document.querySelectorAll(".viewer")].map((box) => box.viewer);
