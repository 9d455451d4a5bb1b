// The rows under the slider: what is damaged, how far joints were moved, the curve of a joint.
import { placeOf, speedOf } from "motion-data";

const BAR = 14, CURVE = 60, TEXT = 15; // heights in pixels

export const CURVES = {
  height: { unit: "m", of: (motion, frame, joint) => motion.positions[3 * (frame * motion.joints + joint) + 1] },
  speed: { unit: "m/s", of: speedOf },
  x: { unit: "m from the hips", of: (motion, frame, joint) => placeOf(motion, frame, joint, 0) },
  z: { unit: "m from the hips", of: (motion, frame, joint) => placeOf(motion, frame, joint, 2) },
};
export const TINT = "rgba(217, 138, 29, .25)"; // of the frames of the chosen finding, behind its curves

// For each frame the share of findings' joints, so that one joint is visible. A finding about the whole
// file, such as jitter, would hide the others.
function damagedShare(findings, frames) {
  const counts = new Float32Array(frames);
  for (const { frames: [first, last] } of findings) {
    if (first === 0 && last >= frames - 1) continue;
    for (let frame = first; frame <= Math.min(last, frames - 1); frame++) counts[frame] += 1;
  }
  return counts.map((count) => (count ? Math.min(1, 0.35 + 0.05 * count) : 0));
}

function largestMoved({ moved, joints, frames }) {
  const largest = new Float32Array(frames);
  for (let i = 0; i < joints * frames; i++) largest[i % frames] = Math.max(largest[i % frames], moved[i] / 255);
  return largest;
}

// Draw curves of as many values over one width, from the lowest to the highest value; return these two.
export function strokeCurves(pen, curves, top, width, height) {
  const all = curves.map(({ values }) => values);
  const low = Math.min(...all.map((values) => values.reduce((a, b) => Math.min(a, b))));
  const high = Math.max(...all.map((values) => values.reduce((a, b) => Math.max(a, b))), low + 1e-3);
  for (const { colour, values } of curves) {
    pen.strokeStyle = colour;
    pen.lineWidth = 1.5;
    pen.beginPath();
    const stride = Math.max(1, Math.floor(values.length / 4000));
    for (let at = 0; at < values.length; at += stride) {
      pen.lineTo(at / Math.max(values.length - 1, 1) * width, top + height - 2 - (values[at] - low) / (high - low) * (height - 4));
    }
    pen.stroke();
  }
  return [low, high];
}

export class Timeline {
  constructor(canvas, motions, findings, frames, rows = {}) {
    Object.assign(this, { canvas, motions, frames, findings });
    this.rows = Object.entries(rows).map(([label, values]) => ({ label, colour: "--share", values }));
    if (findings.length) this.rows.push({ label: "damaged", colour: "--damage", values: damagedShare(findings, frames) });
    for (const motion of motions.filter(({ moved }) => moved)) {
      const label = `${motion.label}: distance from ${motions[0].label}`;
      this.rows.push({ label, colour: "--moved", values: largestMoved(motion) });
    }
    this.still = document.createElement("canvas");
  }

  // Show the curve of a joint of that name; "" hides the row.
  setCurve(name, quantity) {
    const { of, unit } = CURVES[quantity];
    this.curves = this.motions.flatMap((motion) => {
      const joint = motion.names.indexOf(name);
      if (!name || joint < 0) return [];
      return [{ colour: motion.colour, values: Float32Array.from({ length: this.frames }, (_, frame) => of(motion, frame, joint)) }];
    });
    this.curveLabel = `${quantity} of ${name.replaceAll("_", " ")}`;
    this.unit = unit;
    this.width = 0;
  }

  // The first frame in which a joint is elsewhere than in the first motion.
  firstChange() {
    const distances = this.rows.find(({ colour }) => colour === "--moved")?.values ?? [];
    return Math.max(distances.findIndex(Boolean), 0);
  }

  height() {
    return this.rows.length * (TEXT + BAR + 3) + (this.curves?.length ? TEXT + CURVE + 3 : 0);
  }

  // The largest value of each pixel's frames.
  bars(pen, values, top) {
    for (let x = 0; x < this.width; x++) {
      const from = Math.floor(x / this.width * this.frames), to = Math.max(from + 1, Math.ceil((x + 1) / this.width * this.frames));
      let value = 0;
      for (let frame = from; frame < Math.min(to, this.frames); frame++) value = Math.max(value, values[frame]);
      if (value > 0) pen.fillRect(x, top + BAR * (1 - value), 1, BAR * value);
    }
  }

  drawStill(style, sharp) {
    Object.assign(this.still, { width: this.canvas.width, height: this.canvas.height });
    const pen = this.still.getContext("2d"), colour = (name) => style.getPropertyValue(name);
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    pen.font = "11.5px system-ui, sans-serif";
    let top = TEXT;
    for (const row of this.rows) {
      pen.fillStyle = style.backgroundColor;
      pen.fillRect(0, top, this.width, BAR);
      pen.fillStyle = colour(row.colour);
      this.bars(pen, row.values, top);
      pen.fillStyle = style.color;
      pen.fillText(row.label, 0, top - 4);
      top += TEXT + BAR + 3;
    }
    if (!this.curves?.length) return;
    pen.fillStyle = style.backgroundColor;
    pen.fillRect(0, top, this.width, CURVE);
    const [low, high] = strokeCurves(pen, this.curves, top, this.width, CURVE);
    pen.fillStyle = style.color;
    pen.fillText(`${this.curveLabel}, ${low.toFixed(2)} to ${high.toFixed(2)} ${this.unit}`, 0, top - 4);
  }

  // The rows are drawn when something in them has changed, then only the marks above them.
  draw(frame, loop, style) {
    const width = this.canvas.clientWidth, height = this.height();
    this.canvas.hidden = !height;
    if (!height || !width) return;
    const sharp = Math.min(window.devicePixelRatio, 2);
    if (this.width !== width) {
      this.width = width;
      Object.assign(this.canvas, { width: Math.round(width * sharp), height: Math.round(height * sharp) });
      this.canvas.style.height = `${height}px`;
      this.drawStill(style, sharp);
    }
    const pen = this.canvas.getContext("2d");
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
    pen.drawImage(this.still, 0, 0);
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    const x = (value) => value / Math.max(this.frames - 1, 1) * (width - 2);
    if (this.chosen) {
      pen.fillStyle = TINT;
      pen.fillRect(x(this.chosen[0]), 0, x(this.chosen[1]) - x(this.chosen[0]) + 2, height);
    }
    if (loop) {
      pen.fillStyle = "rgba(110, 130, 150, .3)";
      pen.fillRect(0, 0, x(loop[0]), height);
      pen.fillRect(x(loop[1]) + 2, 0, width, height);
    }
    pen.fillStyle = style.color;
    pen.fillRect(x(Math.floor(frame)), 0, 2, height);
  }

  frameAt(x) {
    return Math.round(Math.min(Math.max(x / this.canvas.clientWidth, 0), 1) * (this.frames - 1));
  }
}
