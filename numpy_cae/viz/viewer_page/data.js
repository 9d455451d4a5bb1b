// The motions of a page, and what is computed from their positions. See viewer.py for the data.

// Steps (rows, frames) as they were before they were packed: differences between frames, with the
// sign in the lowest bit, in four planes of bytes.
function unpackedSteps(bytes, frames) {
  const count = bytes.length / 4, steps = new Int32Array(count);
  for (let i = 0; i < count; i++) {
    const packed = bytes[i] | bytes[count + i] << 8 | bytes[2 * count + i] << 16 | bytes[3 * count + i] << 24;
    steps[i] = (packed >>> 1) ^ -(packed & 1);
    if (i % frames) steps[i] += steps[i - 1];
  }
  return steps;
}

// World positions (frames, joints, 3) in metres, of steps (joints, 3, frames) in which all joints
// but the first are relative to the first.
function positionsOf(steps, joints, frames, step) {
  const positions = new Float32Array(steps.length);
  for (let joint = 0; joint < joints; joint++) {
    for (let axis = 0; axis < 3; axis++) {
      const row = (3 * joint + axis) * frames, root = axis * frames;
      for (let frame = 0; frame < frames; frame++) {
        const whole = steps[row + frame] + (joint ? steps[root + frame] : 0);
        positions[(frame * joints + joint) * 3 + axis] = whole * step;
      }
    }
  }
  return positions;
}

const bytesOf = async (text) => new Uint8Array(await inflated(text).arrayBuffer());

// The motions of `data`. Where a motion has as many joints as the first one, its packed steps are
// the differences from those of the first.
export async function readMotions(data) {
  const motions = [];
  let first;
  for (const packed of data.motions) {
    const joints = packed.parents.length;
    const steps = unpackedSteps(await bytesOf(packed.steps), data.frames);
    if (packed.from_first) steps.forEach((value, i) => { steps[i] = value + first[i]; });
    first ??= steps;
    const positions = positionsOf(steps, joints, data.frames, packed.step);
    const moved = packed.moved ? await bytesOf(packed.moved) : null;
    motions.push(withFeatures({ ...packed, positions, moved }, data.frames, data.rate));
  }
  return motions;
}

// A motion with all that the viewer draws: sides, head, feet, size and direction of the body.
export function withFeatures(motion, frames, rate) {
  Object.assign(motion, { frames, rate, joints: motion.parents.length });
  motion.sides = sidesOf(motion.names);
  motion.head = motion.names.findIndex((name) => /head(?!.*(end|top))/i.test(name));
  motion.size = sizeOf(motion);
  motion.radius = 0.011 * motion.size.tall;
  motion.planted = plantedFeet(motion);
  return motion;
}

export function jointPosition(motion, frame, joint, into) {
  return into.fromArray(motion.positions, 3 * (frame * motion.joints + joint));
}

// Centimetres as text, such as "0.4 cm" and "120 cm".
export function centimetres(value) {
  return `${value < 9.95 ? value.toFixed(1) : Math.round(value)} cm`;
}

// The place of a joint on an axis, in metres: the first joint in the world, each other one from the first.
export function placeOf({ positions, joints }, frame, joint, axis) {
  const at = 3 * frame * joints + axis;
  return positions[at + 3 * joint] - (joint ? positions[at] : 0);
}

// How far a joint is from that of another motion, in metres: the first joint in the world, each other
// one from the first.
export function distance(motion, other, frame, joint) {
  return Math.hypot(...[0, 1, 2].map((axis) => placeOf(motion, frame, joint, axis) - placeOf(other, frame, joint, axis)));
}

// 1 for each joint of the left side, -1 for the right, 0 for the middle: a joint is of a side if the
// rig has a joint of the same name with left and right exchanged.
function sidesOf(names) {
  const present = new Set(names.map((name) => name.toLowerCase()));
  const exchanged = [[/left/, "right", 1], [/right/, "left", -1], [/^l/, "r", 1], [/^r/, "l", -1],
    [/([_.])l$/, "$1r", 1], [/([_.])r$/, "$1l", -1], [/([:_.])l/, "$1r", 1], [/([:_.])r/, "$1l", -1]];
  return names.map((name) => {
    const low = name.toLowerCase();
    const found = exchanged.find(([from, to]) => from.test(low) && present.has(low.replace(from, to)));
    return found ? found[2] : 0;
  });
}

// The value that a share of the values does not exceed.
function quantile(values, share) {
  const sorted = Float64Array.from(values).sort();
  return sorted[Math.floor(share * (sorted.length - 1))];
}

// Height and width of the body and of its path. A few frames with a joint far away do not count.
function sizeOf({ positions, joints, frames }) {
  const tops = [], wide = [], across = [[], []];
  for (let frame = 0; frame < frames; frame += Math.ceil(frames / 500)) {
    const at = 3 * frame * joints;
    let top = -Infinity, radius = 0;
    for (let i = at; i < at + 3 * joints; i += 3) {
      top = Math.max(top, positions[i + 1]);
      radius = Math.max(radius, Math.hypot(positions[i] - positions[at], positions[i + 2] - positions[at + 2]));
    }
    tops.push(top);
    wide.push(radius);
    across[0].push(positions[at]);
    across[1].push(positions[at + 2]);
  }
  const tall = Math.max(quantile(tops, 0.95), 0.3 * quantile(wide, 0.95), 1e-3);
  const ends = across.map((values) => [quantile(values, 0.01), quantile(values, 0.99)]);
  return {
    tall, radius: 0.9 * quantile(wide, 0.95), middle: ends.map(([low, high]) => (low + high) / 2),
    path: Math.hypot(...ends.map(([low, high]) => high - low)) / 2,
  };
}

// Horizontal unit vector in which the body faces in a frame: across the line from right to left.
export function facing({ positions, joints, sides }, frame) {
  let x = 0, z = 0;
  sides.forEach((side, joint) => {
    x += side * positions[3 * (frame * joints + joint)];
    z += side * positions[3 * (frame * joints + joint) + 2];
  });
  const length = Math.hypot(x, z);
  return length > 0 ? [-z / length, x / length] : [0, 1];
}

// Metres a second of a joint, over a thirtieth of a second or the neighbouring frames.
export function speedOf({ positions, joints, frames, rate }, frame, joint) {
  const half = Math.max(1, Math.round(rate / 60));
  const from = Math.max(frame - half, 0), to = Math.min(frame + half, frames - 1);
  const a = 3 * (from * joints + joint), b = 3 * (to * joints + joint);
  const way = [0, 1, 2].map((axis) => positions[b + axis] - positions[a + axis]);
  return Math.hypot(...way) * rate / Math.max(to - from, 1);
}

// For each joint of a foot, a byte for each frame: 1 where it is low and slow.
function plantedFeet(motion) {
  const planted = new Map();
  motion.names.forEach((name, joint) => {
    if (!/toe|foot|ankle/i.test(name) || /end|site/i.test(name)) return;
    const height = (frame) => motion.positions[3 * (frame * motion.joints + joint) + 1];
    const all = Array.from({ length: motion.frames }, (_, frame) => height(frame));
    const low = quantile(all, 0.05) + 0.025 * motion.size.tall;
    const slow = 0.15 * motion.size.tall;
    planted.set(joint, Uint8Array.from(all, (y, frame) => y < low && speedOf(motion, frame, joint) < slow));
  });
  return planted;
}
