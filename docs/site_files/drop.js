// On the first page of the site: a .bvh file that is dropped or chosen plays in the viewer. three.js
// reads the file in the browser; nothing is sent anywhere.
import { Vector3 } from "three";
import { BVHLoader } from "bvhloader";
import { withFeatures } from "motion-data";
import { mount } from "motion-viewer";

// World positions in the unit of the file. The loader makes two tracks, positions and rotations, for
// each bone that is not the end of a branch, in the order of the bones.
function readBvh(text) {
  const { skeleton: { bones }, clip: { tracks } } = new BVHLoader().parse(text);
  const times = tracks[0].times, frames = times.length, place = new Vector3();
  const moving = bones.filter((bone) => bone.name !== "ENDSITE");
  const positions = new Float32Array(frames * moving.length * 3);
  for (let frame = 0; frame < frames; frame++) {
    moving.forEach((bone, number) => {
      bone.position.fromArray(tracks[2 * number].values, 3 * frame);
      bone.quaternion.fromArray(tracks[2 * number + 1].values, 4 * frame);
    });
    bones[0].updateMatrixWorld(true);
    moving.forEach((bone, number) =>
      place.setFromMatrixPosition(bone.matrixWorld).toArray(positions, 3 * (frame * moving.length + number)));
  }
  return {
    positions, frames, rate: frames > 1 ? Math.round(1000 / times[1]) / 1000 : 30,
    names: moving.map((bone) => bone.name), parents: moving.map((bone) => moving.indexOf(bone.parent)),
  };
}

// In metres, with the lowest foot on the floor. A body of more than three units is in centimetres,
// one of more than 400 in millimetres.
function toMetres(motion) {
  const heights = Array.from({ length: motion.positions.length / 3 }, (_, i) => motion.positions[3 * i + 1]);
  const first = heights.slice(0, motion.names.length);
  const tall = Math.max(...first) - Math.min(...first);
  const unit = tall > 400 ? 0.001 : tall > 3 ? 0.01 : 1;
  const floor = heights.sort((a, b) => a - b)[Math.floor(heights.length / 200)];
  motion.positions.forEach((value, i) => { motion.positions[i] = (value - (i % 3 === 1 ? floor : 0)) * unit; });
}

// What `numpy-cae` says about a file that it refuses, with the number of the line; "" about others.
function refusal(text) {
  const lines = text.replace(/^\uFEFF/, "").split(/\r\n|\r|\n/).map((line) => line.trim());
  const first = lines.findIndex(Boolean), motion = lines.findIndex((line) => /^MOTION$/i.test(line));
  const quoted = (line) => `'${line.slice(0, 40)}'`;
  if (!/^HIERARCHY\b/i.test(lines[first] ?? ""))
    return `${first + 1}: expected HIERARCHY, as every BVH file begins, found ${quoted(lines[first] ?? "")}`;
  const comma = lines.findIndex((line) => /^(OFFSET\s.*)?-?\d*,\d/i.test(line));
  if (comma >= 0)
    return `${comma + 1}: ${quoted(lines[comma].match(/-?\d*,\d+/)[0])} is not a number: write decimals with a point, not a comma`;
  if (motion < 0) return `${lines.length}: the file ends without MOTION: is it cut off?`;
  const above = lines.slice(0, motion), roots = above.flatMap((line, at) => (/^ROOT\b/i.test(line) ? [at] : []));
  if (roots.length > 1)
    return `${roots[1] + 1}: a second ROOT, ${quoted(lines[roots[1]].slice(5))}: a file may hold one skeleton; delete this one and its columns of values`;
  const channels = above.reduce((sum, line) => sum + Number(line.match(/^CHANNELS\s+(\d+)/i)?.[1] ?? 0), 0);
  const below = lines.flatMap((line, at) => (at > motion && line ? [[at + 1, line]] : []));
  for (const [[at, line], pattern, expected] of [[below[0] ?? [lines.length, ""], /^frames\s*:?\s*\d+$/i, "Frames: and a number"],
    [below[1] ?? [lines.length, ""], /^frame\s*time\s*:?\s*[\d.e+-]+$/i, "Frame Time: and seconds"]]) {
    if (!pattern.test(line)) return `${at}: expected ${expected}, found ${quoted(line)}`;
  }
  const stated = Number(below[0][1].match(/\d+/)[0]);
  if (below.length < 3) return `${below[0][0]}: Frames: says ${stated}, ${stated ? "but" : "and"} no line of values follows`;
  const [wrong, values] = below.slice(2).find(([, line]) => line.split(/\s+/).length !== channels) ?? [];
  return wrong ? `${wrong}: ${values.split(/\s+/).length} values, expected ${channels}: a line for each frame, ` +
    "with one value for each channel of the hierarchy" : "";
}

function play(name, text) {
  const said = document.getElementById("drop-said");
  const problem = refusal(text);
  if (problem) {
    said.textContent = `${name}:${problem}`;
    return;
  }
  try {
    const { frames, rate, ...motion } = readBvh(text);
    if (!motion.positions.every(Number.isFinite)) throw new Error("some values are no numbers");
    toMetres(motion);
    const ready = withFeatures({ ...motion, label: name, colour: "#2f6db5", moved: null }, frames, rate);
    const data = { rate, frames, overlaid: false, furthest: 0, motions: [ready], findings: [], command: "" };
    const box = document.createElement("div");
    box.className = "viewer";
    document.getElementById("hero").replaceChildren(box);
    mount(box, data, Promise.resolve([ready]));
    said.textContent = `${name}: ${frames} frames at ${rate} a second. Nothing was uploaded. To repair it, run ` +
      `numpy-cae repair ${name} -o fixed.bvh --html on your computer.`;
  } catch (error) {
    said.textContent = `${name} cannot be played: ${error.message}. The installed command reads more files and says what is wrong.`;
  }
}

const input = document.getElementById("drop-file");
const take = async ([file]) => { if (file) play(file.name, await file.text()); };
input.addEventListener("change", () => take(input.files));
document.addEventListener("dragover", (event) => event.preventDefault());
document.addEventListener("drop", (event) => {
  event.preventDefault();
  take(event.dataTransfer.files);
});
