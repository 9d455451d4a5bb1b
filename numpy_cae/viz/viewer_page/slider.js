// Draws the figure of a page made by numpy_cae/viz/sliders.py: a control for each slider, and for each
// panel an SVG of curves or of bodies, from the row of the table at which the controls stand.
"use strict";

const WIDTH = 420, HEIGHT = 290;
const AREA = { left: 52, right: WIDTH - 10, top: 26, bottom: HEIGHT - 52 };

function svg(name, attributes, parent, text) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  parent.append(made);
  return made;
}

function element(name, parent, properties) {
  const made = Object.assign(document.createElement(name), properties);
  parent.append(made);
  return made;
}

const short = (value) => String(Number(value.toPrecision(3)));

// A curve's x or y has a row for each position, or is one row for all.
const rowOf = (values, position) => (Array.isArray(values[0]) ? values[position] : values);

// Maps numbers to pixels; the range is that of all positions, so the axes stand still.
function scale(numbers, logarithmic, from, to) {
  const usable = numbers.filter((v) => v !== null && (!logarithmic || v > 0));
  const f = logarithmic ? Math.log10 : (v) => v;
  let low = Math.min(...usable.map(f)), high = Math.max(...usable.map(f));
  if (low === high) [low, high] = [low - 0.5, high + 0.5];
  const margin = 0.04 * (high - low);
  [low, high] = [low - margin, high + margin];
  const place = (v) => from + ((f(v) - low) / (high - low)) * (to - from);
  let step = 10 ** Math.floor(Math.log10((high - low) / 4));
  if (logarithmic) step = Math.max(1, Math.ceil((high - low) / 6));
  else step *= [1, 2, 5, 10].find((factor) => (high - low) / (factor * step) <= 6);
  const ticks = [];
  for (let t = Math.ceil(low / step) * step; t <= high + 1e-9 * step; t += step) {
    const value = logarithmic ? 10 ** t : t;
    ticks.push({ at: place(value), label: logarithmic && Math.abs(t) > 3 ? `1e${Math.round(t)}` : short(value) });
  }
  return { place, ticks };
}

function axes(panel, drawing) {
  const all = (name) => panel.curves.flatMap((curve) => curve[name].flat());
  const across = scale(all("x"), panel.log.includes("x"), AREA.left, AREA.right);
  const up = scale(all("y"), panel.log.includes("y"), AREA.bottom, AREA.top);
  for (const { at, label } of across.ticks) {
    svg("path", { class: "grid", d: `M${at} ${AREA.top}V${AREA.bottom}` }, drawing);
    svg("text", { x: at, y: AREA.bottom + 14, "text-anchor": "middle" }, drawing, label);
  }
  for (const { at, label } of up.ticks) {
    svg("path", { class: "grid", d: `M${AREA.left} ${at}H${AREA.right}` }, drawing);
    svg("text", { x: AREA.left - 4, y: at + 4, "text-anchor": "end" }, drawing, label);
  }
  svg("text", { x: (AREA.left + AREA.right) / 2, y: HEIGHT - 24, "text-anchor": "middle" }, drawing, panel.across);
  svg("text", { x: 4, y: 12 }, drawing, panel.up);
  return [across.place, up.place];
}

function chart(panel, drawing) {
  const [across, up] = axes(panel, drawing);
  const dots = (style) => style === "o" || style === ".";
  const marks = panel.curves.map((curve) => {
    const line = { fill: "none", stroke: curve.colour, "stroke-width": 2 };
    if (dots(curve.style)) Object.assign(line, { "stroke-width": curve.style === "o" ? 9 : 4, "stroke-linecap": "round" });
    else if (curve.style !== "-") line["stroke-dasharray"] = curve.style === ":" ? "2 4" : "6 4";
    return svg("path", line, drawing);
  });
  const legend = svg("text", { x: WIDTH / 2, y: HEIGHT - 6, "text-anchor": "middle" }, drawing);
  for (const { colour, label } of panel.curves.filter((curve) => curve.label))
    svg("tspan", { dx: 12, style: `fill: ${colour}; font-weight: 600` }, legend, label);
  return (position) =>
    panel.curves.forEach((curve, number) => {
      const xs = rowOf(curve.x, position), ys = rowOf(curve.y, position);
      let path = "", open = false;
      ys.forEach((y, i) => {
        const x = xs[i];
        const bad = y === null || x === null || (panel.log.includes("y") && y <= 0) || (panel.log.includes("x") && x <= 0);
        if (bad) { open = false; return; }
        const at = `${across(x).toFixed(1)} ${up(y).toFixed(1)}`;
        path += dots(curve.style) ? `M${at}h0` : `${open ? "L" : "M"}${at}`;
        open = true;
      });
      marks[number].setAttribute("d", path);
    });
}

// The positions of all joints at each frame: running sums of the differences.
function unpacked(actor) {
  return actor.clips.map((differences) => {
    let last = differences[0].map(() => 0);
    return differences.map((frame) => (last = last.map((value, i) => value + frame[i])));
  });
}

function bodies(panel, drawing, view) {
  const actors = panel.actors.map((actor) => ({ ...actor, clips: unpacked(actor) }));
  const every = actors.flatMap((actor) => actor.clips.flat());
  // A few far poses, of damage, may leave the picture.
  const most = (numbers) => numbers.sort((a, b) => a - b)[Math.floor(0.98 * (numbers.length - 1))];
  const highest = 1.05 * most(every.map((frame) => Math.max(...frame.filter((_, i) => i % 3 === 1))));
  const widest = most(every.map((frame) => Math.max(...frame.filter((_, i) => i % 3 !== 1).map(Math.abs))));
  const place = WIDTH / actors.length;
  const size = Math.min((HEIGHT - 50) / highest, place / (2.2 * widest));
  const floor = HEIGHT - 22;
  svg("path", { class: "grid", d: `M0 ${floor}H${WIDTH}` }, drawing);
  const paths = actors.map((actor, n) => {
    svg("text", { x: place * (n + 0.5), y: HEIGHT - 6, "text-anchor": "middle", style: `fill: ${actor.colour}; font-weight: 600` }, drawing, actor.label);
    return svg("path", { fill: "none", stroke: actor.colour, "stroke-width": 4, "stroke-linecap": "round" }, drawing);
  });
  return (position, time) =>
    actors.forEach((actor, n) => {
      const clip = actor.clips[actor.clips.length > 1 ? position : 0];
      const points = clip[Math.floor(time * panel.rate) % clip.length];
      const turn = (view() * Math.PI) / 180, middle = place * (n + 0.5);
      const at = (joint) => {
        const [x, y, z] = points.slice(3 * joint, 3 * joint + 3);
        const right = x * Math.cos(turn) - z * Math.sin(turn);
        return `${(middle + size * right).toFixed(1)} ${(floor - size * y).toFixed(1)}`;
      };
      const lines = actor.parents.map((parent, joint) => (parent < 0 ? "" : `M${at(parent)}L${at(joint)}`));
      paths[n].setAttribute("d", lines.join(""));
    });
}

function start(table) {
  const controls = document.getElementById("controls"), panels = document.getElementById("panels");
  const texts = [...document.getElementById("texts").children].map((item) => item.textContent);
  let place = table.start;
  const inputs = table.controls.map(({ name, values }, number) => {
    const later = table.controls.slice(number + 1).reduce((n, other) => n * other.values.length, 1);
    const label = element("label", controls, { textContent: name });
    const value = Math.floor(place / later) % values.length;
    const input = element("input", label, { type: "range", min: 0, max: values.length - 1, step: 1, value });
    return { input, values, later, shown: element("span", label, { ariaHidden: "true" }) };
  });
  let view = () => 60, playing = false;
  const moving = table.panels.some((panel) => panel.actors?.some((actor) => actor.clips[0].length > 1));
  if (table.panels.some((panel) => panel.actors)) {
    const label = element("label", controls, { textContent: "view, degrees" });
    const input = element("input", label, { type: "range", min: 0, max: 350, step: 10, value: 60 });
    input.id = "view";
    view = () => Number(input.value);
    input.addEventListener("input", () => draw());
  }
  const draws = table.panels.map((panel) => {
    const named = panel.title || (panel.actors ?? panel.curves).map((part) => part.label).join(", ");
    const drawing = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": named }, panels);
    if (panel.title) svg("text", { x: WIDTH - 6, y: 12, "text-anchor": "end", style: "font-weight: 600" }, drawing, panel.title);
    return panel.curves ? chart(panel, drawing) : bodies(panel, drawing, view);
  });
  let time = 0, last = 0;
  const draw = () => draws.forEach((each) => each(place, time));
  function moved() {
    place = 0;
    for (const { input, values, later, shown } of inputs) {
      place += Number(input.value) * later;
      shown.textContent = short(values[input.value]);
      input.setAttribute("aria-valuetext", shown.textContent);
    }
    document.getElementById("text").textContent = texts[place];
    draw();
  }
  inputs.forEach(({ input }) => input.addEventListener("input", moved));
  if (moving) {
    const button = element("button", controls, { type: "button", textContent: "pause" });
    const tick = (now) => {
      if (!playing) return;
      time += Math.min(Math.max(now - last, 0), 100) / 1000;
      last = now;
      draw();
      requestAnimationFrame(tick);
    };
    const play = (on) => {
      playing = on;
      button.textContent = on ? "pause" : "play";
      last = performance.now();
      if (on) requestAnimationFrame(tick);
    };
    button.addEventListener("click", () => play(!playing));
    play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  }
  moved();
  // In a notebook the page stands in a frame, which gets the page's height.
  const fit = () => { if (window.frameElement) frameElement.style.height = `${document.body.offsetHeight + 12}px`; };
  new ResizeObserver(fit).observe(document.body);
}

(async () => {
  const packed = atob(JSON.parse(document.getElementById("table").textContent));
  const bytes = Uint8Array.from(packed, (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  start(await new Response(stream).json());
})();
