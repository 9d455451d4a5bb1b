// The list of what was found to be damaged: each finding with its details, its curve, whether its repair is
// kept, and the command line that writes what the page shows of it.
import { centimetres, distance, placeOf } from "motion-data";
import { TINT, strokeCurves } from "motion-timeline";

const AXES = ["x", "height", "z"];
const WIDTH = 224, HEIGHT = 56; // of a curve, pixels

// The command that writes the repair of these findings, by their numbers, into a file of its own.
export function onlyCommand(command, numbers, name) {
  return `${command.replace(/_finding_0(?=\.\w+)/, `_${name}`)} --only ${numbers.join(" ")}`;
}

// The command that also repairs what was only proposed, as if the user had found it.
function proposedCommand(command, { joint, frames }) {
  const named = joint === "body" ? "" : ` --joint ${joint}`;
  return `${command.replace(/_finding_0(?=\.\w+)/, "_proposal")}${named} --frames ${frames.join(" ")}`;
}

const framesOf = ([first, last]) => (last > first ? `frames ${first} to ${last}` : `frame ${first}`);
const isProposed = ({ status }) => Boolean(status) && status !== "repaired";

// The joint of a finding or one below it that two motions place furthest apart in its frames, and the axis
// on which they do. Of a long finding some of the frames are compared.
function movedMost([before, after = before], { joint, frames: [first, last] }) {
  const { names, parents } = before, top = names.indexOf(joint);
  const isBelow = (at) => at === top || top < 0 || (parents[at] >= 0 && isBelow(parents[at]));
  const most = { at: Math.max(top, 0), axis: 1, metres: 0 };
  if (names.join() !== after.names.join()) return most;
  for (const at of names.keys()) {
    for (let frame = first; isBelow(at) && frame <= last; frame += Math.ceil((last - first + 1) / 300)) {
      const metres = distance(after, before, frame, at);
      if (metres <= most.metres) continue;
      const apart = [0, 1, 2].map((axis) => Math.abs(placeOf(after, frame, at, axis) - placeOf(before, frame, at, axis)));
      Object.assign(most, { at, metres, axis: apart.indexOf(Math.max(...apart)) });
    }
  }
  return most;
}

export class FindingsPanel {
  constructor(box, element, { findings, command, motions, frames, rate }, onChosen) {
    Object.assign(this, { element, command, motions, frames, rate, onChosen, kept: new Set() });
    const left = findings.filter(({ status }) => status === "left");
    const proposed = findings.filter((finding) => isProposed(finding) && !left.includes(finding));
    const found = findings.filter((finding) => !isProposed(finding));
    this.found = found;
    this.rows = [];
    if (command && found.length) {
      this.all = element(box, "div", { className: "detail" });
      this.said = element(this.all, "p");
      this.code = this.commandLine(this.all, "");
    }
    this.section(box, found, found.length === 1 ? "1 finding" : `${found.length} findings`);
    this.section(box, proposed, proposed.length === 1 ? "1 proposal, not changed" : `${proposed.length} proposals, not changed`);
    this.section(box, left, `${left.length} found, left alone`);
    if (this.all) this.sayWhatIsKept();
  }

  section(box, findings, title) {
    if (!findings.length) return;
    this.element(box, "h2", { textContent: title });
    const list = this.element(box, "ol");
    findings.forEach((finding, at) => this.row(list, finding, at + 1));
  }

  row(list, finding, number) {
    const { joint, frames, kind, cm } = finding, item = this.element(list, "li"), moved = movedMost(this.motions, finding);
    const mover = this.motions[0].names[moved.at];
    const text = (name) => name.replaceAll("_", " ");
    const button = this.element(item, "button", { type: "button", ariaExpanded: "false" });
    this.element(button, "b", { textContent: `${number}. ${text(joint)}` });
    this.element(button, "span", { textContent: [framesOf(frames), kind, cm ? `${mover === joint ? "" : `the ${text(mover)} `}moves ${centimetres(cm)}` : ""].filter(Boolean).join(" \u00b7 ") });
    const detail = this.element(item, "div", { className: "detail", hidden: true });
    const row = { finding, number, button, detail, moved, mover };
    button.addEventListener("click", () => {
      this.choose(row);
      button.scrollIntoView?.({ block: "nearest" });
    });
    this.rows.push(row);
    if (!isProposed(finding)) this.kept.add(number);
  }

  // Show the details of a finding below its line, and nothing of the others.
  choose(row) {
    for (const each of this.rows) {
      each.detail.hidden = each !== row;
      each.button.ariaExpanded = String(each === row);
    }
    if (!row.detail.childElementCount) this.fill(row);
    this.onChosen(row);
  }

  fill({ finding, number, detail, moved }) {
    const { evidence, confidence } = finding;
    const sure = confidence === undefined ? "" : `Confidence ${Math.round(100 * confidence)}%.`;
    this.element(detail, "p", { textContent: [evidence && `${evidence[0].toUpperCase()}${evidence.slice(1)}.`, sure].filter(Boolean).join(" ") });
    this.curve(detail, finding, moved);
    if (!this.command) return;
    if (isProposed(finding)) {
      this.element(detail, "p", { textContent: "For a file in which this alone is repaired:" });
      this.commandLine(detail, proposedCommand(this.command, finding));
      return;
    }
    if (this.found.length < 2) return;
    const label = this.element(detail, "label");
    const box = this.element(label, "input", { type: "checkbox", checked: this.kept.has(number) });
    label.append("keep this repair");
    box.addEventListener("change", () => this.keep(number, box.checked));
    const alone = this.element(detail, "details");
    this.element(alone, "summary", { textContent: "this repair alone, without the others" });
    this.commandLine(alone, onlyCommand(this.command, [number], `finding_${number}`));
  }

  keep(number, kept) {
    this.kept[kept ? "add" : "delete"](number);
    this.rows.forEach((row) => row.button.classList.toggle("rejected", !isProposed(row.finding) && !this.kept.has(row.number)));
    this.sayWhatIsKept();
  }

  // What the written file has, and, where not every box is ticked, the command that writes what is ticked.
  sayWhatIsKept() {
    const all = this.found.length, numbers = [...this.kept].sort((a, b) => a - b);
    const some = numbers.length > 0 && numbers.length < all;
    const written = `The written file has ${all > 1 ? `all ${all} repairs` : "this repair"}.`;
    const ticked = numbers.length ? "Untick one that is wrong to get a command that leaves it out." : "None is kept: use the file before.";
    this.said.textContent = `${written} ${some ? `For a file with the ${numbers.length} that are ticked, run:` : all > 1 ? ticked : ""}`;
    for (const each of [this.code, this.code.nextSibling]) each.hidden = !some;
    this.code.textContent = onlyCommand(this.command, numbers, "kept");
  }

  curve(detail, finding, { at, axis }) {
    const [first, last] = finding.frames, around = Math.round(this.rate / 2);
    const from = Math.max(first - around, 0), to = Math.min(last + around, this.frames - 1);
    const { names } = this.motions[0], pair = this.motions.slice(0, 2).filter((motion) => motion.names[at] === names[at]);
    const curves = pair.map((motion) => ({
      colour: motion.colour, values: Float32Array.from({ length: to - from + 1 }, (_, i) => placeOf(motion, from + i, at, axis)),
    }));
    const name = `${AXES[axis]} of ${names[at].replaceAll("_", " ")}${at ? " from the hips" : ""}`;
    const canvas = this.element(detail, "canvas", { width: 2 * WIDTH, height: 2 * HEIGHT, role: "img" });
    const pen = canvas.getContext("2d");
    pen.scale(2, 2);
    const across = (frame) => (frame - from) / Math.max(to - from, 1) * WIDTH;
    pen.fillStyle = TINT;
    pen.fillRect(across(first), 0, Math.max(across(last) - across(first), 1), HEIGHT);
    const [low, high] = strokeCurves(pen, curves, 0, WIDTH, HEIGHT);
    const text = `${name}, ${low.toFixed(2)} to ${high.toFixed(2)} m, frames ${from} to ${to}: before orange, after blue`;
    canvas.ariaLabel = text;
    this.element(detail, "p", { className: "caption", textContent: text });
  }

  commandLine(parent, text) {
    const code = this.element(parent, "code", { tabIndex: 0, textContent: text });
    const copy = this.element(parent, "button", { type: "button", textContent: "copy" });
    copy.addEventListener("click", async () => {
      try {
        await navigator.clipboard.writeText(code.textContent);
        copy.textContent = "copied";
      } catch {
        getSelection().selectAllChildren(code);
        copy.textContent = "selected: press Ctrl C";
      }
      setTimeout(() => { copy.textContent = "copy"; }, 2000);
    });
    return code;
  }
}
