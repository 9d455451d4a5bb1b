// A map of takes: a click on a point plays its take, and draws the path of the take's damaged copy
// through its projection to the true code. See code_map.py for the data.
import { mount } from "motion-viewer";
import { readMotions } from "motion-data";

const NS = "http://www.w3.org/2000/svg";
const WIDTH = 640, HEIGHT = 560, MARGIN = 34;
const COLOURS = ["#d1701f", "#2f78c4", "#2e8b57", "#8a5bb5"];
// Shapes around (0, 0), so that a kind is told by its form where colours cannot be told apart.
const SHAPES = ["M-6,0a6,6 0 1 0 12,0a6,6 0 1 0 -12,0", "M-5.5,-5.5h11v11h-11z", "M0,-7l7,12h-14z", "M0,-7.5l6,7.5l-6,7.5l-6,-7.5z"];

const takes = JSON.parse(document.getElementById("takes").textContent);
const kinds = [...new Set(takes.map((take) => take.kind))];
const player = document.getElementById("player");
const choice = document.getElementById("choice");

function draw(parent, tag, attributes, text = "") {
  const node = document.createElementNS(NS, tag);
  Object.entries(attributes).forEach(([name, value]) => node.setAttribute(name, value));
  node.textContent = text;
  parent.append(node);
  return node;
}

const places = takes.flatMap((take) => [take.place, ...take.path]);
const lowest = [0, 1].map((axis) => Math.min(...places.map((place) => place[axis])));
const extent = [0, 1].map((axis) => Math.max(...places.map((place) => place[axis])) - lowest[axis]);
const perUnit = Math.min((WIDTH - 2 * MARGIN) / extent[0], (HEIGHT - 2 * MARGIN) / extent[1]);
function onMap(place) {
  const [x, y] = place.map((value, axis) => perUnit * (value - lowest[axis]));
  return [MARGIN + x, HEIGHT - MARGIN - y];
}

const svg = draw(document.getElementById("map"), "svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "group", "aria-label": "Map of the takes" });
draw(draw(draw(svg, "defs", {}), "marker", { id: "arrow", viewBox: "0 0 8 8", refX: 8, refY: 4, markerWidth: 7, markerHeight: 7, orient: "auto" }),
  "path", { d: "M0,0L8,4L0,8z", class: "dot" });
const points = takes.map((take, number) => {
  const kind = kinds.indexOf(take.kind);
  const [x, y] = onMap(take.place);
  const point = draw(svg, "path", {
    d: SHAPES[Math.floor(kind / COLOURS.length) % SHAPES.length], fill: COLOURS[kind % COLOURS.length],
    transform: `translate(${x} ${y})`, class: "point", role: "button", tabindex: 0, "aria-label": take.label,
  });
  draw(point, "title", {}, take.label);
  point.addEventListener("click", () => choose(number));
  point.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === " ") {
      event.preventDefault();
      choose(number);
    }
  });
  choice.append(new Option(take.label, number));
  return point;
});
for (const kind of kinds) {
  const own = takes.filter((take) => take.kind === kind).map((take) => onMap(take.place));
  const [x, y] = [0, 1].map((axis) => own.reduce((sum, place) => sum + place[axis], 0) / own.length);
  draw(svg, "text", { x, y: y - 11, "text-anchor": "middle", "pointer-events": "none" }, kind);
}
const paths = draw(svg, "g", { "pointer-events": "none" });

function choose(number) {
  const take = takes[number];
  choice.value = number;
  points.forEach((point, place) => point.classList.toggle("chosen", place === number));
  drawPath(take);
  player.firstChild?.viewer?.dispose();
  const box = Object.assign(document.createElement("div"), { className: "viewer" });
  player.replaceChildren(box);
  mount(box, take.motions, readMotions(take.motions));
  document.getElementById("said").textContent = take.text;
}

function drawPath(take) {
  paths.replaceChildren();
  if (!take.path.length) return;
  const corners = [...take.path, take.place].map(onMap);
  for (let i = 1; i < corners.length; i++) {
    draw(paths, "path", { class: "path", d: `M${corners[i - 1]}L${corners[i]}` });
  }
  ["damaged", "projected", "true"].forEach((name, i) => {
    if (i < 2) draw(paths, "circle", { cx: corners[i][0], cy: corners[i][1], r: 4, class: "dot" });
    draw(paths, "text", { x: corners[i][0] + 8, y: corners[i][1] + 16 }, name);
  });
}

choice.addEventListener("change", () => choose(Number(choice.value)));
choose(0);
